"""What a tracked motion asks for at every step, and the controls that would do it undisturbed."""

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco
import numpy as np

from motiondiffuse_ros.errors import PhysicsError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.dynamics import inverse_dynamics
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.humanoid import DAMPING_RATIO
from motiondiffuse_ros.physics.state import motion_to_qpos, state_velocities

FALL_DISTANCE = 0.5
"""Fallen once the joints are this far from the reference in the mean [m] (PHC's rule)."""

SHORTEST = 0.1
"""A shorter motion is not tracked [s]."""

_TORQUE_RATE = 40.0


def check_trackable(motion: Motion) -> None:
    """Raise PhysicsError if a motion is too short or not finite."""
    if motion.duration < SHORTEST:
        raise PhysicsError(
            f"tracking needs a motion of {SHORTEST} s or more, got {motion.duration:.2f} s"
        )
    if not (np.isfinite(motion.root).all() and np.isfinite(motion.rotations).all()):
        raise PhysicsError("tracking needs a finite motion, got values that are not")


@dataclass(frozen=True, eq=False)
class Reference:
    """A motion at the time steps of a model; N steps.

    Attributes:
        qpos: [N, 70].
        qvel: [N, 69].
        controls: Targets of the PD actuators [N, 63], rad.
        sensed: What the model's sensors would show [N, S].
    """

    qpos: Array = field(repr=False)
    qvel: Array = field(repr=False)
    controls: Array = field(repr=False)
    sensed: Array = field(repr=False)

    def __len__(self) -> int:
        return len(self.qpos)


def reference_states(motion: Motion) -> tuple[Array, Array]:
    """Return what a trackable motion asks for in each frame: `qpos` [T, 70] and `qvel` [T, 69]."""
    qpos = motion_to_qpos(motion)
    inner, _ = state_velocities(qpos, motion.fps)
    return qpos, np.concatenate([inner[:1], inner, inner[-1:]])


def make_reference(motion: Motion, model: mujoco.MjModel) -> Reference:
    """Sample a trackable motion at a model's time step.

    The targets lead the hinges by what the actuators' damping takes, and by the torques that
    inverse dynamics finds with the floor's forces acting.
    """
    rate = 1.0 / model.opt.timestep
    qpos, qvel = reference_states(motion.resample(rate))
    torques = _torques(motion, np.arange(len(qpos)) / rate)
    controls = qpos[:, 7:] + DAMPING_RATIO * qvel[:, 6:] + torques / hinge_table().stiffness

    data = mujoco.MjData(model)
    sensed = np.empty((len(qpos), model.nsensordata))
    for step in range(len(qpos)):
        data.qpos, data.qvel = qpos[step], qvel[step]
        mujoco.mj_forward(model, data)
        sensed[step] = data.sensordata
    return Reference(qpos, qvel, controls, sensed)


def _torques(motion: Motion, times: Array) -> Array:
    """Return the torques of inverse dynamics at times [n, 63], inside their limits, N m."""
    table = hinge_table()
    torques = inverse_dynamics(motion.resample(_TORQUE_RATE)).torques
    torques = np.clip(torques, -table.torque_limits, table.torque_limits)
    known = (np.arange(len(torques)) + 1) / _TORQUE_RATE
    return np.stack([np.interp(times, known, column) for column in torques.T], axis=1)
