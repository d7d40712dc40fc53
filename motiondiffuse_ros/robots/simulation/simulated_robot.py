"""A robot in MuJoCo that follows joint trajectories with its position actuators."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from motiondiffuse_ros.errors import PhysicsError, RobotError
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.simulation.assistance import RootAssistance
from motiondiffuse_ros.robots.simulation.executed_motion import ExecutedMotion
from motiondiffuse_ros.robots.simulation.reference_path import Reference, ReferencePath
from motiondiffuse_ros.robots.trajectory import JointTrajectory

FALLEN = 0.5
"""A root below this part of its height at rest counts as fallen."""

_DIVERGED = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


@dataclass(frozen=True)
class SimulationConfig:
    """How the simulated robot follows.

    Attributes:
        assisted: Hold the floating base on the root trajectory by an outside force and torque;
            False leaves balance to the joints alone, so that most motions end in a fall.
        approach_s: Time taken from the present pose to the first point [s].
        log_rate: Samples a second of the executed motion [Hz].
    """

    assisted: bool = True
    approach_s: float = 1.0
    log_rate: float = 50.0


class SimulatedRobot:
    """One robot on flat ground, standing at rest until it is given a trajectory."""

    def __init__(self, robot: Robot, config: SimulationConfig | None = None) -> None:
        """Put the robot upright over the origin.

        Args:
            robot: Its model has position actuators, one a joint, named as the joints.
            config: How it follows.

        Raises:
            RobotError: If a joint has no position actuator of its name.
        """
        self.robot = robot
        self.config = config or SimulationConfig()
        self.model = copy(robot.model)
        self._assistance = RootAssistance(self.model) if self.config.assisted else None
        self.data = mujoco.MjData(self.model)
        self._actuators, self._lead = _position_actuators(robot)
        self.data.qpos[7:] = robot.rest_positions
        mujoco.mj_forward(self.model, self.data)
        self._standing = float(self.data.qpos[2])
        self._path = ReferencePath.hold(self.data.qpos)
        self._start = 0.0
        self._log: list[tuple[Array, Array, float]] = []
        self.state = "waiting"

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.data.time)

    @property
    def fallen(self) -> bool:
        """Whether the root is far below its height at rest."""
        return float(self.data.qpos[2]) < FALLEN * self._standing

    @property
    def progress(self) -> float:
        """Part of the trajectory that has been followed, 0 to 1."""
        if self._path.duration == 0.0:
            return 0.0
        return float(np.clip((self.time - self._start) / self._path.duration, 0.0, 1.0))

    def follow(self, trajectory: JointTrajectory) -> None:
        """Go to the first point from the present pose, then follow; replaces any other.

        The root path is moved on the ground plane to where the robot stands and faces.

        Raises:
            RobotError: If the joints are not the robot's.
        """
        if set(trajectory.joint_names) != set(self.robot.joint_names):
            raise RobotError(
                f"the trajectory's {len(trajectory.joint_names)} joints are not those of "
                f"'{self.robot.name}' ({len(self.robot.joint_names)})"
            )
        order = [trajectory.joint_names.index(name) for name in self.robot.joint_names]
        ordered = replace(
            trajectory,
            joint_names=self.robot.joint_names,
            positions=trajectory.positions[:, order],
            velocities=trajectory.velocities[:, order],
        )
        self._path = ReferencePath.approach_and_follow(
            self.data.qpos.copy(), ordered, self.config.approach_s
        )
        self._start = self.time
        self._log = []
        self.state = "approaching"

    def step(self) -> None:
        """Advance by the model's time step.

        Raises:
            PhysicsError: If the simulation diverged; the robot is back at rest then.
        """
        elapsed = self.time - self._start
        reference = self._path.at(elapsed)
        self._advance_state(elapsed, reference)
        self.data.ctrl[self._actuators] = reference.positions + self._lead * reference.velocities
        if self._assistance is not None:
            self._assistance.apply(self.data, reference)
        mujoco.mj_step(self.model, self.data)
        if any(self.data.warning[kind].number for kind in _DIVERGED):
            self._reset()
            raise PhysicsError("the simulation diverged; the robot was put back to rest")

    def executed(self) -> ExecutedMotion:
        """Return what was done since the first point of the present trajectory."""
        if not self._log:
            raise PhysicsError("nothing was followed yet")
        qpos, reference, assistance = (np.array(part) for part in zip(*self._log, strict=True))
        return ExecutedMotion(
            self.robot.name,
            self.config.log_rate,
            self.config.assisted,
            qpos,
            reference,
            assistance,
        )

    def _advance_state(self, elapsed: float, reference: Reference) -> None:
        following = elapsed - self._path.approach_s
        if self.state == "approaching" and following >= 0.0:
            self.state = "following"
        if self.state != "following":
            return
        if following * self.config.log_rate >= len(self._log):
            pull = self._assistance.body_weights(self.data) if self._assistance else 0.0
            self._log.append((self.data.qpos.copy(), reference.qpos(), pull))
        if elapsed >= self._path.duration:
            self.state = "finished"

    def _reset(self) -> None:
        time = self.time
        mujoco.mj_resetData(self.model, self.data)
        self.data.time = time
        self.data.qpos[7:] = self.robot.rest_positions
        mujoco.mj_forward(self.model, self.data)
        self._path = ReferencePath.hold(self.data.qpos)
        self.state = "waiting"


def _position_actuators(robot: Robot) -> tuple[Array, Array]:
    """Return the actuator of each joint [J] and its damping over its stiffness [J], s.

    A position actuator damps towards zero velocity. Leading the set-point by that time times
    the velocity asked for makes it damp towards that velocity instead.
    """
    model = robot.model
    by_joint = {
        model.joint(int(model.actuator_trnid[a, 0])).name: a
        for a in range(model.nu)
        if model.actuator_biastype[a] == mujoco.mjtBias.mjBIAS_AFFINE
    }
    missing = [name for name in robot.joint_names if name not in by_joint]
    if missing:
        raise RobotError(f"robot '{robot.name}': joint '{missing[0]}' has no position actuator")
    actuators = np.array([by_joint[name] for name in robot.joint_names])
    stiffness = model.actuator_gainprm[actuators, 0]
    damping = -model.actuator_biasprm[actuators, 2]
    return actuators, damping / stiffness
