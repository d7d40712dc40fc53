"""Every physics measure of a motion as a series over its frames, ready to be cut by time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.dynamics import inverse_dynamics
from motiondiffuse_ros.physics.foot_skating import SIDES, foot_skating
from motiondiffuse_ros.physics.geometry import body_probes
from motiondiffuse_ros.physics.ground_contact import ground_errors
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.joint_limits import POSITION_TOLERANCE, limit_excess
from motiondiffuse_ros.physics.smoothness import joint_jerk
from motiondiffuse_ros.physics.state import hinges_from_motion

RATE = 20.0
"""All measures are taken at this rate [Hz]: that of the corpus, and what GMD's ratio supposes."""

MIN_FRAMES = 5
"""Fewer frames at `RATE` have no dynamics to judge."""


class Limits(Protocol):
    """Limits of the 63 hinges, as a robot whose joints they are states them."""

    @property
    def lower(self) -> Array: ...

    @property
    def upper(self) -> Array: ...

    @property
    def velocity_limits(self) -> Array: ...

    @property
    def torque_limits(self) -> Array: ...


@dataclass(frozen=True, eq=False)
class Series:
    """One measure over the frames.

    Attributes:
        values: [T]; NaN where the measure is not defined.
        who: The body part or joint that each value is about; None if it is the whole body.
    """

    values: Array = field(repr=False)
    who: Sequence[str] | None = field(default=None, repr=False)

    def cut(self, start: int, stop: int) -> Series:
        """Return the frames from start up to, not including, stop."""
        who = None if self.who is None else self.who[start:stop]
        return Series(self.values[start:stop], who)


def measure(motion: Motion, limits: Limits) -> dict[str, Series]:
    """Measure a motion.

    Args:
        motion: At `RATE`, `MIN_FRAMES` or more, floor at z = 0.
        limits: Of the 63 hinges.

    Returns:
        Series by name: `penetrate`, `float`, `skate`, `phys_err` (mm, see `ground_contact`),
        `skates` (0 or 1 where a foot is low, see `foot_skating`), `support_slide` (m/s),
        `jerk` (m/s^3), `range_excess` (rad), `speed_excess` (rad/s), `torque_excess` (N m),
        `residual_force` (body weights), `residual_torque` (body weights times metre).
    """
    frames = motion.frames
    ground, skating = ground_errors(motion), foot_skating(motion)
    heights = body_probes().heights(motion)
    lowest = [CANONICAL.names[body_probes().joints[p]] for p in heights.argmin(axis=1)]

    skates = np.where(skating.low.any(axis=1), skating.skating.any(axis=1), np.nan)
    support = np.argmin(np.where(np.isnan(skating.slide_speed), np.inf, skating.slide_speed), 1)
    feet = [f"{side} foot" for side in SIDES]

    jerk = joint_jerk(motion)
    dynamics = inverse_dynamics(motion)
    names = hinge_table().names
    excess = limit_excess(
        hinges_from_motion(motion), motion.fps, limits.lower, limits.upper, limits.velocity_limits
    )
    position = np.where(excess.position > POSITION_TOLERANCE, excess.position, 0.0)
    torque = np.maximum(np.abs(dynamics.torques) - limits.torque_limits, 0.0)
    return {
        "penetrate": Series(ground.penetrate, lowest),
        "float": Series(ground.float_),
        "skate": Series(ground.skate),
        "phys_err": Series(ground.phys_err),
        "skates": _aligned(skates, frames),
        "support_slide": _aligned(skating.support_slide, frames, [feet[s] for s in support]),
        "jerk": _worst(jerk, frames, CANONICAL.names),
        "range_excess": _worst(position, frames, names),
        "speed_excess": _worst(excess.speed, frames, names),
        "torque_excess": _worst(torque, frames, names),
        "residual_force": _aligned(dynamics.residual_force, frames),
        "residual_torque": _aligned(dynamics.residual_torque, frames),
    }


def _worst(values: Array, frames: int, names: Sequence[str]) -> Series:
    """Reduce [n, J] to the largest of the columns and its name."""
    return _aligned(values.max(axis=1), frames, [names[int(j)] for j in values.argmax(axis=1)])


def _aligned(values: Array, frames: int, who: list[str] | None = None) -> Series:
    """Pad what differences have shortened, with the middle of each difference on its frame."""
    before = (frames - len(values)) // 2
    after = frames - len(values) - before
    padded = np.pad(np.asarray(values, dtype=np.float64), (before, after), constant_values=np.nan)
    if who is not None:
        who = [*[""] * before, *who, *[""] * after]
    return Series(padded, who)
