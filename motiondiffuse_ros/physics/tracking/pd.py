"""The motion as the reference of a PD controller under gravity and contact.

Nobody holds the humanoid: its joints follow the reference by torques within their limits, and its
root goes where the feet take it. A PD controller has no balance of its own, so that even real
walking falls after a few steps; how long it stays up, and how near, still ranks motions.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, field
from functools import cache

import mujoco
import numpy as np

from motiondiffuse_ros.errors import Cancelled
from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion.resample import sample_at
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.humanoid import DAMPING_RATIO, TIMESTEP, humanoid_model
from motiondiffuse_ros.physics.tracking.model import DIVERGED
from motiondiffuse_ros.physics.tracking.reference import (
    FALL_DISTANCE,
    check_trackable,
    reference_states,
)

CONTROL_RATE = 100.0
"""How often the controller's targets are renewed [Hz]."""

_FIRST = 250
"""Frames of the reference that are made before any are known to be needed, and then twice as many
each time: most bodies fall soon, and ten minutes at this rate are a hundred megabytes."""

_STEPS = round(1.0 / CONTROL_RATE / TIMESTEP)


@dataclass(frozen=True, eq=False)
class Tracking:
    """What became of a motion in simulation.

    Attributes:
        time_to_fall: First time at which the body has fallen, or the motion's duration if it
            never did, s.
        fell: Whether it fell.
        diverged: Whether the simulation broke down then.
        mpjpe: Mean distance of the joints from the reference before the fall, mm.
        qpos: The executed states [N, 70] at `CONTROL_RATE`, up to the fall.
        torques: Joint torques that the controller applied [N, 63], N m.
    """

    time_to_fall: float
    fell: bool
    diverged: bool
    mpjpe: float
    qpos: Array = field(repr=False)
    torques: Array = field(repr=False)


def track(
    motion: Motion,
    *,
    cancelled: Callable[[], bool] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Tracking:
    """Simulate a motion without assistance; the same motion always ends the same.

    Args:
        motion: 0.1 s or more.
        cancelled: Asked at every control step.
        progress: Told the share done, 0 to 1, at every control step.

    Raises:
        PhysicsError: If the motion is too short or not finite.
        Cancelled: If `cancelled` says so.
    """
    check_trackable(motion)
    frames = motion.frames_at(CONTROL_RATE)
    reference = _Reference.of(motion, min(frames, _FIRST))
    model = _model_that_stops()
    data = mujoco.MjData(model)
    bodies = [model.body(name).id for name in CANONICAL.names]
    data.qpos, data.qvel = reference.qpos[0], reference.qvel[0]
    states, torques, distances = [reference.qpos[0]], [np.zeros(model.nu)], [0.0]
    fell = diverged = False
    for frame in range(1, frames):
        if len(reference.qpos) < frames and frame == len(reference.qpos) - 1:
            reference = _Reference.of(motion, min(frames, 2 * len(reference.qpos)))
        if cancelled is not None and cancelled():
            raise Cancelled("tracking was cancelled")
        data.ctrl = reference.targets[frame]
        mujoco.mj_step(model, data, _STEPS)
        diverged = any(data.warning[kind].number for kind in DIVERGED)
        if diverged:
            break
        error = np.linalg.norm(data.xpos[bodies] - reference.positions[frame], axis=1).mean()
        fell = bool(error > FALL_DISTANCE)
        if fell:
            break
        states.append(data.qpos.copy())
        torques.append(data.actuator_force.copy())
        distances.append(float(error))
        if progress is not None:
            progress(frame / (frames - 1))
    up = not (fell or diverged)
    return Tracking(
        time_to_fall=motion.duration if up else len(states) / CONTROL_RATE,
        fell=not up,
        diverged=diverged,
        mpjpe=1000.0 * float(np.mean(distances)),
        qpos=np.array(states),
        torques=np.array(torques),
    )


@dataclass(frozen=True, eq=False)
class _Reference:
    """The first frames of a motion at `CONTROL_RATE`, and what the controller aims at in each."""

    positions: Array
    qpos: Array
    qvel: Array
    targets: Array

    @classmethod
    def of(cls, motion: Motion, frames: int) -> _Reference:
        sampled = sample_at(motion, np.arange(frames) / CONTROL_RATE, CONTROL_RATE)
        qpos, qvel = reference_states(sampled)
        # the actuator damps towards zero speed; this shift makes it damp towards the reference's
        return cls(sampled.positions, qpos, qvel, qpos[:, 7:] + DAMPING_RATIO * qvel[:, 6:])


@cache
def _model_that_stops() -> mujoco.MjModel:
    """The humanoid without MuJoCo's silent reset on divergence: it must be seen."""
    model = copy(humanoid_model())
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    return model
