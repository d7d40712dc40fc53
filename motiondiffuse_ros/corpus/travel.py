"""How the root goes in a window: what can be stated with certainty about way, side and turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.rotations import Array

_MIN_SIDE = 0.4
_SIDE_RATIO = 2.0
_STRAIGHT = 0.9


@dataclass(frozen=True)
class Travel:
    """The way of the root over one window, in the frame of its heading at every moment.

    Attributes:
        left: Distance gone to the left (negative: right), m.
        ahead: Distance gone ahead (negative: back), m.
        swaying: Sum of all movement to either side, m.
        path: Length of the way, m.
        turned: Heading at the end against the start, to the left, rad.
        seconds: Duration.
    """

    left: float
    ahead: float
    swaying: float
    path: float
    turned: float
    seconds: float

    @classmethod
    def of(cls, features: Array, representation: Representation, fps: float) -> Travel:
        """Measure a window's features [T, D], not normalised; they must have root velocities."""
        groups = representation.groups()
        velocity = features[:, groups["root_velocity"]]  # x is left, z ahead
        left, ahead = velocity.sum(axis=0) / fps
        return cls(
            float(left),
            float(ahead),
            float(np.abs(velocity[:, 0]).sum() / fps),
            float(np.hypot(*velocity.T).sum() / fps),
            float(features[:, groups["yaw_velocity"]].sum() / fps),
            len(features) / fps,
        )

    @property
    def side(self) -> int:
        """1 if it goes to the left for certain, -1 to the right, 0 otherwise."""
        least = max(_MIN_SIDE, _SIDE_RATIO * abs(self.ahead), 0.8 * self.swaying)
        return int(np.sign(self.left)) if abs(self.left) > least else 0

    @property
    def straight(self) -> int:
        """1 if it goes straight ahead for certain, -1 if straight back, 0 otherwise."""
        return int(np.sign(self.ahead)) if abs(self.ahead) > _STRAIGHT * self.path else 0

    @property
    def speed(self) -> float:
        """Mean speed along the way, m/s."""
        return self.path / self.seconds
