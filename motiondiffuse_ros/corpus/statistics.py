"""Mean and scale of the features, over the training split and its mirror image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from motiondiffuse_ros.errors import CheckpointError
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.rotations import Array


@dataclass(frozen=True, eq=False)
class Statistics:
    """Normalisation of features: (x - mean) / std.

    Attributes:
        mean: [D].
        std: [D], one value within each block of like units, as HumanML3D does, so that joints
            that hardly move are not blown up to unit variance.
    """

    mean: Array = field(repr=False)
    std: Array = field(repr=False)

    def normalise(self, features: Array) -> Array:
        """Return (features - mean) / std."""
        return (features - self.mean) / self.std

    def denormalise(self, features: Array) -> Array:
        """Undo `normalise`."""
        return features * self.std + self.mean

    def save(self, path: Path) -> None:
        """Write `mean` and `std` as safetensors."""
        save_file({"mean": self.mean.astype(np.float32), "std": self.std.astype(np.float32)}, path)

    @classmethod
    def load(cls, path: Path) -> Statistics:
        """Read what `save` wrote.

        Raises:
            CheckpointError: If the file is missing or altered.
        """
        try:
            data = load_file(path)
            return cls(data["mean"], data["std"])
        except (OSError, SafetensorError, KeyError) as error:
            raise CheckpointError(f"statistics {path}: cannot be read ({error})") from error


def compute_statistics(features: Sequence[Array], representation: Representation) -> Statistics:
    """Compute the statistics of clips [T_i, D] and their mirror images."""
    index, sign = representation.mirror()
    count = sum(len(f) for f in features)
    total = np.zeros(representation.dim)
    squares = np.zeros(representation.dim)
    for f in features:
        f = f.astype(np.float64)
        total += f.sum(axis=0)
        squares += (f**2).sum(axis=0)
    mean = total / count
    square = squares / count
    mean, square = 0.5 * (mean + mean[index] * sign), 0.5 * (square + square[index])
    std = np.sqrt(np.maximum(square - mean**2, 0.0))
    for block in representation.groups().values():
        std[block] = std[block].mean()
    return Statistics(mean.astype(np.float32), np.maximum(std, 1e-6).astype(np.float32))
