"""The simulated body that executes plans, and the record of what it did."""

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco
import numpy as np

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.tracking.lookahead import STATE
from motiondiffuse_ros.physics.tracking.model import DIVERGED
from motiondiffuse_ros.physics.tracking.reference import FALL_DISTANCE, Reference

_WHOLE_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@dataclass(eq=False)
class Record:
    """Samples of one execution, one a step.

    Attributes:
        qpos: States [70].
        torques: Of the hinges [63], N m.
        forces: Of the floor on the bodies [22, 3], N.
        errors: Distance of each joint from the reference [22], m.
        local_errors: The same with the roots in one place [22], m.
    """

    qpos: list[Array] = field(default_factory=list)
    torques: list[Array] = field(default_factory=list)
    forces: list[Array] = field(default_factory=list)
    errors: list[Array] = field(default_factory=list)
    local_errors: list[Array] = field(default_factory=list)

    def cut(self, samples: int) -> None:
        """Forget what came after a number of samples."""
        for series in vars(self).values():
            del series[samples:]


class Plant:
    """The humanoid on its floor, from the first state of a reference on. Nothing holds it."""

    def __init__(self, model: mujoco.MjModel, reference: Reference) -> None:
        """Put the body where the reference begins, at the reference's speed."""
        self.record = Record()
        self.fallen = self.diverged = False
        self.step = 0
        self._model, self._reference = model, reference
        self._data = mujoco.MjData(model)
        self._data.qpos, self._data.qvel = reference.qpos[0], reference.qvel[0]
        self._data.ctrl = reference.controls[0]
        self._floor = model.geom("floor").id
        bodies = [model.body(name).id for name in CANONICAL.names]
        self._bodies = np.array(bodies)
        self._joints = {body: joint for joint, body in enumerate(bodies)}
        mujoco.mj_forward(model, self._data)
        self._log()

    @property
    def state(self) -> Array:
        """What simulation needs to go on from here."""
        state = np.empty(mujoco.mj_stateSize(self._model, STATE))
        mujoco.mj_getState(self._model, self._data, state, STATE)
        return state

    @property
    def stopped(self) -> bool:
        """Whether the body fell, the simulation broke down or the reference is at its end."""
        return self.fallen or self.diverged or self.step >= len(self._reference) - 1

    @property
    def error(self) -> float:
        """Mean distance of the joints from the reference [m]."""
        return float(self.record.errors[-1].mean())

    def saved(self) -> tuple[int, Array]:
        """Return all that the simulation goes on from, for `restore`."""
        state = np.empty(mujoco.mj_stateSize(self._model, _WHOLE_STATE))
        mujoco.mj_getState(self._model, self._data, state, _WHOLE_STATE)
        return self.step, state

    def restore(self, saved: tuple[int, Array]) -> None:
        """Go back to an earlier time, and forget what came after it."""
        self.step, state = saved
        mujoco.mj_resetData(self._model, self._data)
        mujoco.mj_setState(self._model, self._data, state, _WHOLE_STATE)
        self.record.cut(self.step + 1)
        self.fallen = self.diverged = False

    def execute(self, controls: Array) -> None:
        """Apply controls [n, 63] for a step each, until the end."""
        for control in controls:
            self._data.ctrl = control
            mujoco.mj_step(self._model, self._data)
            self.step += 1
            self.diverged = any(self._data.warning[kind].number for kind in DIVERGED)
            if not self.diverged:
                self._log()
            if self.stopped:
                return

    def _log(self) -> None:
        data, wanted = self._data, self._reference.sensed[self.step]
        # a step leaves positions of the bodies as they were before it
        mujoco.mj_kinematics(self._model, data)
        positions = data.xpos[self._bodies]
        off = positions - wanted[: positions.size].reshape(positions.shape)
        errors = np.linalg.norm(off, axis=1)
        self.fallen = bool(errors.mean() > FALL_DISTANCE)
        record = self.record
        record.qpos.append(data.qpos.copy())
        record.torques.append(data.actuator_force.copy())
        record.forces.append(self._floor_forces())
        record.errors.append(errors)
        record.local_errors.append(np.linalg.norm(off - off[0], axis=1))

    def _floor_forces(self) -> Array:
        forces, wrench = np.zeros((len(self._bodies), 3)), np.zeros(6)
        for index, contact in enumerate(self._data.contact):
            if self._floor not in contact.geom:
                continue
            mujoco.mj_contactForce(self._model, self._data, index, wrench)
            first, second = contact.geom
            # the force acts on the second geom; the rows of the frame are the contact's axes
            body, sign = (second, 1.0) if first == self._floor else (first, -1.0)
            joint = self._joints[int(self._model.geom_bodyid[body])]
            forces[joint] += sign * wrench[:3] @ contact.frame.reshape(3, 3)
        return forces
