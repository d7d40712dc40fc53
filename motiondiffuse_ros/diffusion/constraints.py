"""What a sampled motion must keep to, imposed on the clean prediction at every denoising step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import torch
from torch import Tensor

from motiondiffuse_ros.corpus.statistics import Statistics


class Constraint(Protocol):
    """Returns the nearest features that satisfy it, for a sensible meaning of near."""

    def __call__(self, clean: Tensor) -> Tensor:
        """Return normalised clean features [C, T, D] that satisfy it."""
        ...


def apply(constraints: Sequence[Constraint], clean: Tensor) -> Tensor:
    """Impose constraints one after the other; the last one holds exactly."""
    for constraint in constraints:
        clean = constraint(clean)
    return clean


class KeptFeatures:
    """Some features of some frames are given (imputation): edits, in-betweening, continuation."""

    def __init__(self, values: Tensor, mask: Tensor) -> None:
        """Take what is given.

        Args:
            values: Normalised features [T, D].
            mask: [T, D] from 0 (free) to 1 (given); between them, a mixture.
        """
        self._values, self._mask = values, mask

    def __call__(self, clean: Tensor) -> Tensor:
        """Return clean features [C, T, D] with the given ones in their places."""
        return clean + self._mask * (self._values - clean)


class Eased:
    """Frames next to given ones go on from them.

    What a given frame differs by from the prediction, and how fast, is added to the free frames
    before and after it and dies away along a cubic: their movement stays the predicted one. Pulling
    them to the given pose instead would only put off the jump.
    """

    def __init__(self, values: Tensor, rows: Tensor, frames: int) -> None:
        """Lay out how each given frame next to free ones is let go.

        Args:
            values: Normalised features [T, D].
            rows: Frames at which they are given [T], bool.
            frames: Over how many frames what is added dies away.
        """
        self._values, self._frames = values, frames
        steps = rows.int().diff()
        self._ends = [(int(i), 1) for i in (steps == -1).nonzero()]
        self._ends += [(int(i) + 1, -1) for i in (steps == 1).nonzero()]
        self._rows = rows

    def __call__(self, clean: Tensor) -> Tensor:
        """Return clean features [C, T, D]; the given frames themselves are left alone."""
        missing = self._values - clean
        out = clean.clone()
        for end, way in self._ends:
            place = torch.arange(1, self._frames + 1, device=clean.device)
            at = end + way * place
            inside = (at >= 0) & (at < clean.shape[1])
            at, u = at[inside], (place[inside] / (self._frames + 1))[:, None]
            free = (~self._rows[at])[:, None]
            before = end - way
            has_speed = 0 <= before < clean.shape[1] and bool(self._rows[before])
            speed = missing[:, end] - missing[:, before] if has_speed else 0.0 * missing[:, end]
            fading = (1 - u) ** 2 * (
                (1 + 2 * u) * missing[:, None, end] + u * (self._frames + 1) * speed[:, None]
            )
            out[:, at] += free * fading
        return out


class OnPlainFeatures:
    """A constraint on features as they are, not normalised."""

    def __init__(self, constraint: Callable[[Tensor], Tensor], statistics: Statistics) -> None:
        """Take the constraint and how the denoiser's features were normalised."""
        self._constraint = constraint
        self._mean = torch.from_numpy(statistics.mean)
        self._std = torch.from_numpy(statistics.std)

    def __call__(self, clean: Tensor) -> Tensor:
        """Return normalised clean features [C, T, D] that satisfy it."""
        mean, std = self._mean.to(clean.device), self._std.to(clean.device)
        return (self._constraint(clean * std + mean) - mean) / std
