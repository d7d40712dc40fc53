"""Which targets tracking by sampling corrects, and how the corrections run over time."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.hinge_table import hinge_table

_SAME = 1e-9  # two times no further apart are one [s]

# hinges that balance needs, and the size of a large correction of each [rad]
_CORRECTED = {
    "left_hip_x": 0.4,
    "left_hip_y": 0.4,
    "left_hip_z": 0.4,
    "left_knee_y": 0.4,
    "left_ankle_x": 0.4,
    "left_ankle_y": 0.4,
    "spine1_x": 0.3,
    "spine1_y": 0.3,
    "spine1_z": 0.3,
    "left_shoulder_x": 0.5,
    "left_shoulder_z": 0.5,
}


@cache
def corrected_hinges() -> tuple[NDArray[np.intp], Array]:
    """Return the indices of the corrected hinges [D] and their scales [D], rad."""
    both = _CORRECTED | {name.replace("left", "right"): scale for name, scale in _CORRECTED.items()}
    indices = [k for k, name in enumerate(hinge_table().names) if name in both]
    return np.array(indices), np.array([both[hinge_table().names[k]] for k in indices])


@dataclass(frozen=True, eq=False)
class OffsetPath:
    """Piecewise linear offsets over a horizon, from a given start through free knots.

    Attributes:
        knots: Times of the free knots [K], s.
        times: Times of the steps of the horizon [H], s.
        basis: Weight at each step of the start and of each knot [H, K + 1].
    """

    knots: Array
    times: Array = field(repr=False)
    basis: Array = field(repr=False)

    @classmethod
    def over(cls, knots: tuple[float, ...], times: Array) -> OffsetPath:
        """Lay knots [s] over steps [s]."""
        return cls(np.array(knots), times, _hats((0.0, *knots), times))

    def offsets(self, start: Array, values: Array) -> Array:
        """Return the offsets [n, H, D] of a start [D] and knots' values [n, K, D]."""
        steady = self.basis[:, 0, None] * start
        return steady + np.einsum("hk,nkd->nhd", self.basis[:, 1:], values)

    def knots_before(self, time: float) -> int:
        """Return how many of the knots can have an effect at a time [s]."""
        return int(np.sum(np.concatenate([[0.0], self.knots[:-1]]) < time - _SAME))

    def moved_on(self, start: Array, values: Array, by: float) -> tuple[Array, Array]:
        """Return the start and the knots of the same path for a horizon that begins later [s]."""
        path = np.concatenate([start[None], values])
        at = np.concatenate([[0.0], self.knots]) + by
        moved = _hats((0.0, *self.knots), at) @ path
        # what the old horizon did not reach fades towards no offset
        moved[at > self.knots[-1] + _SAME] *= 0.7
        return moved[0], moved[1:]


def _hats(knots: tuple[float, ...], times: Array) -> Array:
    return np.stack([np.interp(times, knots, unit) for unit in np.eye(len(knots))], axis=1)
