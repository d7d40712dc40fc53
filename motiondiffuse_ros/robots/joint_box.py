"""Limits of the joints for mink: ranges, narrowed to what can be reached from the last pose."""

from __future__ import annotations

import mink
import numpy as np
from mink.limits import Constraint

from motiondiffuse_ros.motion.rotations import Array

LARGEST_STEP = 0.2
"""Of a joint [rad]: the linear picture that a step goes by holds no farther."""


class JointBox(mink.Limit):
    """Keeps joints between two bounds; the floating base is free."""

    def __init__(self, lower: Array, upper: Array) -> None:
        """Take the range [J], rad, of the joints after the base."""
        self.range = lower, upper
        self._bounds = lower, upper
        joints = np.eye(len(lower) + 6)[6:]
        self._sides = np.concatenate([joints, -joints])

    def around(self, joints: Array, reach: Array) -> None:
        """Narrow the bounds to `reach` [J], rad, about a pose [J] inside the range."""
        lower, upper = self.range
        self._bounds = np.maximum(lower, joints - reach), np.minimum(upper, joints + reach)

    def compute_qp_inequalities(self, configuration: mink.Configuration, dt: float) -> Constraint:
        """Return what the bounds leave for the next step."""
        joints = configuration.data.qpos[7:]
        lower, upper = self._bounds
        # rounding may leave a joint a hair outside, from where a step of zero must be allowed
        room = np.concatenate([upper - joints, joints - lower])
        return Constraint(G=self._sides, h=np.clip(room, 0.0, LARGEST_STEP))
