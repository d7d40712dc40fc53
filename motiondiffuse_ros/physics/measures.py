"""Every physics measure of a motion as a series over its frames, ready to be cut by time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.dynamics import Dynamics
from motiondiffuse_ros.physics.foot_skating import CONTACT_HEIGHT, skating_of
from motiondiffuse_ros.physics.ground_contact import ground_errors_of
from motiondiffuse_ros.physics.joint_limits import POSITION_TOLERANCE, limit_excess
from motiondiffuse_ros.physics.self_collision import self_overlap
from motiondiffuse_ros.physics.smoothness import jerk_of

RATE = 20.0
"""All measures are taken at this rate [Hz]: that of the corpus, and what GMD's ratio supposes."""

MIN_FRAMES = 5
"""Fewer frames at `RATE` have no dynamics to judge."""


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


def measure(states: BodyStates, dynamics: Dynamics) -> dict[str, Series]:
    """Measure a body.

    Args:
        states: At `RATE`, `MIN_FRAMES` or more.
        dynamics: Of those states.

    Returns:
        Series by name: `penetrate`, `float`, `skate`, `phys_err` (mm, see `ground_contact`),
        `contact_left_foot` and so on (1 where it touches the floor), `skates` (0 or 1 where a
        foot is low, see `foot_skating`), `support_slide` (m/s), `jerk` (m/s^3), `range_excess`
        (rad), `speed_excess` (rad/s), `torque_excess` (N m), `power` (W, the largest over the
        joints), `residual_force` (body weights), `residual_torque` (body weights times metre),
        `balance` and `next_step` (mm, see `balance`), `self_collision` (mm).
    """
    frames, limits = len(states.qpos), states.limits
    heights = states.points.places[..., 2]
    lowest = [states.point_names[int(p)] for p in heights.argmin(axis=1)]
    ground = ground_errors_of(heights.min(axis=1), np.concatenate(states.soles, axis=1))
    skating = skating_of(states.feet, states.soles, states.fps)
    skates = np.where(skating.low.any(axis=1), skating.skating.any(axis=1), np.nan)
    support = np.argmin(np.where(np.isnan(skating.slide_speed), np.inf, skating.slide_speed), 1)
    feet = [name.replace("_", " ") for name in states.foot_names]
    contacts = {
        f"contact_{name}": Series((sole[..., 2].min(axis=1) < CONTACT_HEIGHT).astype(float))
        for name, sole in zip(states.foot_names, states.soles, strict=True)
    }

    overlap, overlapping = self_overlap(states.model, states.qpos)
    excess = limit_excess(
        states.qpos[:, 7:], states.fps, limits.lower, limits.upper, limits.velocity_limits
    )
    position = np.where(excess.position > POSITION_TOLERANCE, excess.position, 0.0)
    torque = np.maximum(np.abs(dynamics.torques) - limits.torque_limits, 0.0)
    names = states.joint_names
    return {
        "penetrate": Series(ground.penetrate, lowest),
        "float": Series(ground.float_),
        "skate": Series(ground.skate),
        "phys_err": Series(ground.phys_err),
        **contacts,
        "skates": _aligned(skates, frames),
        "support_slide": _aligned(skating.support_slide, frames, [feet[s] for s in support]),
        "jerk": _worst(jerk_of(states.places, states.fps), frames, states.place_names),
        "range_excess": _worst(position, frames, names),
        "speed_excess": _worst(excess.speed, frames, names),
        "torque_excess": _worst(torque, frames, names),
        "power": _worst(np.abs(dynamics.power), frames, names),
        "residual_force": _aligned(dynamics.residual_force, frames),
        "residual_torque": _aligned(dynamics.residual_torque, frames),
        "balance": _aligned(1000.0 * np.maximum(dynamics.poise.from_support, 0.0), frames),
        "next_step": _aligned(1000.0 * np.maximum(dynamics.poise.from_next_step, 0.0), frames),
        "self_collision": Series(1000.0 * overlap, overlapping),
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
