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
