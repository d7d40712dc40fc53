"""What a text on some parts imagines of the rest of the body, while noise is high.

With masks alone every window sees, from the first step on, the body that all texts make together:
legs that are told to run see an arm held up, which nobody who runs does in the data, and stand
still. So above some noise level each window keeps a noisy rest of the body of its own. Below it all
see the one body and fit their details to each other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor

from motiondiffuse_ros.diffusion.composition import Window
from motiondiffuse_ros.diffusion.process import to_clean


class Imagination:
    """How each window's noisy features differ from those of the whole motion.

    A sampler's step is linear in what it is given and what is predicted, and adds the same noise to
    all. So the differences are denoised by themselves, without noise (DDIM), whatever the sampler.
    """

    def __init__(
        self,
        windows: Sequence[Window],
        alphas: Tensor,
        kind: str,
        *,
        above: float,
        device: torch.device,
    ) -> None:
        """Find out what each window has no say in.

        Args:
            windows: Of the timeline.
            alphas: Cumulative product of the noise schedule at every training step.
            kind: `DenoiserConfig.prediction_type`.
            above: Noise level, as part of the training steps, above which windows differ.
            device: Of the noisy features.
        """
        self._windows, self._alphas, self._kind = windows, alphas, kind
        self._above = above
        self._hidden = [_hidden(window, device) for window in windows]
        self._clean: list[Tensor | None] = [None] * len(windows)
        self._noise: list[Tensor | None] = [None] * len(windows)

    def at(self, step: int) -> list[Tensor | None] | None:
        """Return what to add to each window's noisy features [C, frames, D], None being nothing.

        Or None for all from the step on where windows no longer differ.
        """
        if step <= self._above * len(self._alphas):
            return None
        alpha = self._alphas[step]
        return [
            None
            if clean is None or noise is None
            else alpha.sqrt() * clean + (1 - alpha).sqrt() * noise
            for clean, noise in zip(self._clean, self._noise, strict=True)
        ]

    def keep(self, rows: Sequence[int]) -> None:
        """Go on with some candidates."""
        for values in (self._clean, self._noise):
            values[:] = [None if x is None else x[list(rows)] for x in values]

    def learn(
        self,
        step: int,
        added: Sequence[Tensor | None],
        predictions: Sequence[Tensor],
        whole: Tensor,
    ) -> None:
        """Take in what was predicted.

        Args:
            step: Of `at`.
            added: What `at` returned.
            predictions: Of each window [C, frames, D].
            whole: That of the whole motion [C, T, D].
        """
        alpha = self._alphas[step]
        for w, (window, hidden) in enumerate(zip(self._windows, self._hidden, strict=True)):
            if hidden is None:
                continue
            differs = hidden * (predictions[w] - whole[:, window.start : window.stop])
            noisy = added[w]
            noisy = torch.zeros_like(differs) if noisy is None else noisy
            clean = to_clean(self._kind, differs, noisy, alpha)
            self._clean[w] = clean
            self._noise[w] = (noisy - alpha.sqrt() * clean) / (1 - alpha).sqrt()


def _hidden(window: Window, device: torch.device) -> Tensor | None:
    """Return [frames, D]: 1 where others own the feature, 0 where the window does, None if all 0.

    Between neighbours in time of the same parts nothing is hidden, as weights fall for all features
    alike.
    """
    presence = window.weight.max(axis=1, keepdims=True)
    hidden = 1.0 - window.weight / np.maximum(presence, 1e-9)
    if not hidden.any():
        return None
    return torch.from_numpy(hidden.astype(np.float32)).to(device)
