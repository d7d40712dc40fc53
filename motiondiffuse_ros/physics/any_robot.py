"""The report on a trajectory of any robot that has an MJCF."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.dynamics import state_dynamics
from motiondiffuse_ros.physics.measures import MIN_FRAMES, RATE, measure
from motiondiffuse_ros.physics.mjcf_states import mjcf_states
from motiondiffuse_ros.physics.report import Report, TimedText, report_on, unjudged


def assess_states(
    model: mujoco.MjModel,
    qpos: Array,
    fps: float,
    *,
    feet: Sequence[str],
    velocity_limits: Array | None = None,
    segments: Sequence[TimedText] = (),
) -> Report:
    """Judge states of a robot with a floating base on a floor at z = 0.

    The measures and criteria are those of `assess`; the fitted score and the simulation, which
    know the humanoid only, take no part.

    Args:
        model: A free joint first, then joints of one axis each (`mjcf_states.load_mjcf`).
        qpos: [T, nq]: place of the base, its quaternion wxyz, joints. Values that are not finite
            make an implausible motion.
        fps: Frames per second.
        feet: Names of the bodies whose solids are the soles.
        velocity_limits: Of the joints after the base, rad/s; none if None, since MJCF has none.
        segments: Spans of time to be judged on their own as well.

    Raises:
        InputError: If the model has another structure or the arguments do not fit it.
    """
    if not np.isfinite(qpos).all():
        return unjudged("the trajectory holds values that are not finite")
    states = mjcf_states(model, qpos, fps, feet=feet, velocity_limits=velocity_limits)
    if len(states.qpos) < MIN_FRAMES:
        return unjudged(
            f"the trajectory lasts {(len(qpos) - 1) / fps:.2f} s; "
            f"dynamics need {(MIN_FRAMES - 1) / RATE:.2f} s or more"
        )
    return report_on(measure(states, state_dynamics(states)), segments)
