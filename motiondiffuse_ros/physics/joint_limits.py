"""How far hinges go beyond their ranges and speeds."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from motiondiffuse_ros.motion.rotations import Array

POSITION_TOLERANCE = np.radians(1.0)
"""Beyond a range by up to this [rad] is no violation."""


@dataclass(frozen=True, eq=False)
class LimitExcess:
    """Excess over the limits, 0 inside.

    Attributes:
        position: [T, J], rad.
        speed: Over the speed limit, between each frame and the next [T - 1, J], rad/s.
    """

    position: Array = field(repr=False)
    speed: Array = field(repr=False)

    @property
    def position_violation(self) -> float:
        """Share of frames in which a joint is beyond its range."""
        return float((self.position > POSITION_TOLERANCE).any(axis=1).mean())

    @property
    def speed_violation(self) -> float:
        """Share of frames in which a joint is faster than its limit."""
        return float((self.speed > 0.0).any(axis=1).mean()) if len(self.speed) else 0.0


def limit_excess(
    joints: Array, fps: float, lower: Array, upper: Array, speed_limits: Array
) -> LimitExcess:
    """Compare joint positions [T, J] (rad, continuous) with limits [J]."""
    beyond = np.maximum(np.maximum(lower - joints, joints - upper), 0.0)
    speed = np.abs(np.diff(joints, axis=0)) * fps
    return LimitExcess(position=beyond, speed=np.maximum(speed - speed_limits, 0.0))
