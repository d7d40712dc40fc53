"""The outside force and torque that hold a simulated robot's floating base on its path."""

from __future__ import annotations

import mujoco
import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.robots.simulation.reference_path import Reference

NATURAL_FREQUENCY = 15.0
"""Of the critically damped pull, as if the whole robot hung on the root rigidly [rad/s]."""

GYRATION = 0.3
"""Radius of gyration that turns mass into the inertia of the pull's torque [m]."""

_ROOT = slice(0, 6)


class RootAssistance:
    """Pulls the root towards a reference like a critically damped spring in six directions.

    No robot has this: what is executed with it shows the joints' motion, not its balance. How
    much it pulls is recorded.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        """Take mass from the model, and put the pull's damping into it.

        There the integrator treats it implicitly; the root alone is too light for an explicit one.
        """
        body = int(model.jnt_bodyid[0])
        mass = float(model.body_subtreemass[body])
        inertia = np.repeat([mass, mass * GYRATION**2], 3)
        self._stiffness = inertia * NATURAL_FREQUENCY**2
        self._damping = 2.0 * inertia * NATURAL_FREQUENCY
        self._weight = mass * float(np.linalg.norm(model.opt.gravity))
        model.dof_damping[_ROOT] = self._damping

    def apply(self, data: mujoco.MjData, reference: Reference) -> None:
        """Set the pull of the next step."""
        position, orientation = data.qpos[:3], data.qpos[3:7]
        # a free joint's rotational forces are in the body's frame
        back = rot.conjugate(orientation)
        off = rot.to_rotation_vector(rot.multiply(back, reference.root_orientation))
        error = np.concatenate([reference.root_position - position, off])
        velocity = np.concatenate(
            [reference.root_linear_velocity, rot.rotate(back, reference.root_angular_velocity)]
        )
        data.qfrc_applied[_ROOT] = self._stiffness * error + self._damping * velocity

    def body_weights(self, data: mujoco.MjData) -> float:
        """Return the size of the force now applied, in body weights."""
        force = data.qfrc_applied[:3] - self._damping[:3] * data.qvel[:3]
        return float(np.linalg.norm(force)) / self._weight
