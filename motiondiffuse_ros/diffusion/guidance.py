"""The denoiser under guidance, with all that stays the same over steps made once."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch
from torch import Tensor

from motiondiffuse_ros.diffusion.attention import AttentionContext
from motiondiffuse_ros.diffusion.denoiser import Conditioning, Denoiser
from motiondiffuse_ros.diffusion.prepared import prepared
from motiondiffuse_ros.diffusion.threads import in_halves

_STYLE_ROWS = 64
"""Steps times texts whose stylization vectors are made at once: reading their weights takes as long
for one row as for many."""


class GuidedDenoiser:
    """Predicts for rows of a fixed set of texts, at steps that are known before."""

    def __init__(
        self,
        denoiser: Denoiser,
        conditioning: Conditioning,
        unconditional: Conditioning,
        steps: Sequence[int],
        scale: Callable[[int], float],
        *,
        bf16: bool,
    ) -> None:
        """Prepare.

        Args:
            denoiser: In evaluation mode.
            conditioning: Of the texts.
            unconditional: One row, of the empty text.
            steps: Diffusion steps, in the order in which they will come.
            scale: Guidance scale at a step; 1 is the conditional model alone.
            bf16: Whether products are in bfloat16.
        """
        dtype = torch.bfloat16 if bf16 else torch.float32
        self._denoiser = prepared(denoiser, dtype)
        every = conditioning.beside(unconditional)
        self._free = len(conditioning.pooled)
        self._contexts = tuple(context.to(dtype) for context in every.contexts)
        self._pooled, self._style_of = torch.unique(every.pooled, dim=0, return_inverse=True)
        self._steps, self._scale = list(steps), scale
        self._styles: dict[int, Tensor] = {}
        self._of_rows: tuple[list[int], list[AttentionContext]] = [], []

    def __call__(self, noisy: Tensor, step: int, lengths: Tensor, rows: Tensor) -> Tensor:
        """Return the prediction [B, T, D] for noisy features.

        Args:
            noisy: Normalised noisy features [B, T, D].
            step: Diffusion step of all rows.
            lengths: Frames that count in each row [B].
            rows: Which text each row is of [B].
        """
        scale = self._scale(step)
        if scale != 1.0:  # both passes in one batch
            noisy, lengths = torch.cat([noisy, noisy]), torch.cat([lengths, lengths])
            rows = torch.cat([rows, torch.full_like(rows, self._free)])
        rows = rows.to(noisy.device)
        contexts, styles = self._contexts_of(rows), self._styles_at(step)[self._style_of[rows]]

        def predict(some: slice) -> Tensor:
            of_some = [context.expand(some) for context in contexts]
            return self._denoiser(noisy[some], lengths[some], of_some, styles[some])

        count = len(noisy)
        on_cpu = noisy.device.type == "cpu"  # a GPU shares out a batch by itself
        prediction = in_halves(predict, count) if on_cpu else predict(slice(count))
        if scale == 1.0:
            return prediction
        conditional, free = prediction.chunk(2)
        return free + scale * (conditional - free)

    def _contexts_of(self, rows: Tensor) -> list[AttentionContext]:
        """Return what rows attend to; most timelines ask for the same rows at every step."""
        wanted = rows.tolist()
        if self._of_rows[0] != wanted:
            self._of_rows = wanted, [context.expand(rows) for context in self._contexts]
        return self._of_rows[1]

    def _styles_at(self, step: int) -> Tensor:
        if step not in self._styles:
            first = self._steps.index(step)
            count = max(1, _STYLE_ROWS // len(self._pooled))
            steps = self._steps[first : first + count]
            self._styles = dict(zip(steps, self._denoiser.styles(steps, self._pooled), strict=True))
        return self._styles[step]
