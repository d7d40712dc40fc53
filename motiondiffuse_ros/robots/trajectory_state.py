"""What a trajectory asks of a robot at any time, and what the body has done so far.

The joints of the humanoid are read back as a motion. Those of other robots cannot be: for them it
is the motion that the trajectory was made from.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.resample import sample_at
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.state import qpos_to_motion
from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.start_state import RootState, StartState
from motiondiffuse_ros.robots.trajectory import JointTrajectory


class TrajectoryState:
    """A trajectory between its points: cubics through positions and velocities."""

    def __init__(self, trajectory: JointTrajectory) -> None:
        """Take a trajectory; its last pose is held after its end."""
        self.trajectory = trajectory
        self._joints = CubicHermiteSpline(
            trajectory.times, trajectory.positions, trajectory.velocities
        )

    @cached_property
    def _root(self) -> CubicHermiteSpline:
        t = self.trajectory
        return CubicHermiteSpline(t.times, t.root_position, t.root_linear_velocity)

    @cached_property
    def _turn(self) -> Slerp:
        t = self.trajectory
        return Slerp(t.times, Rotation.from_quat(t.root_orientation, scalar_first=True))

    def joints(self, time: float) -> tuple[Array, Array]:
        """Return positions [J], rad, and velocities [J], rad/s, at a time from the start [s]."""
        t = self.trajectory
        if time >= t.duration:  # exactly at rest, without a spline's rounding
            return t.positions[-1], t.velocities[-1]
        time = max(time, 0.0)
        return self._joints(time), self._joints(time, 1)

    def at(self, time: float) -> StartState:
        """Return the whole state at a time from the start [s]."""
        t = self.trajectory
        positions, velocities = self.joints(time)
        time = float(np.clip(time, 0.0, t.duration))
        spin = [np.interp(time, t.times, column) for column in t.root_angular_velocity.T]
        moving = 1.0 if time < t.duration else 0.0
        root = RootState(
            position=self._root(time),
            orientation=self._turn(time).as_quat(scalar_first=True),
            linear_velocity=moving * self._root(time, 1),
            angular_velocity=np.array(spin),
        )
        return StartState(positions, velocities, root)

    def motion_up_to(self, robot: Robot, time: float, seconds: float, fps: float) -> Motion:
        """Return what the body has done in the last seconds before a time.

        Args:
            robot: Whose trajectory it is.
            time: Of the last frame, from the start [s]; after the end the last pose is held.
            seconds: Length, at most; the motion does not begin before the trajectory.
            fps: Frame rate of the result, Hz.

        Raises:
            RobotError: If the robot's joints are not the skeleton's own, and the trajectory does
                not know what it was made from.
        """
        frames = int(np.floor(min(time, seconds) * fps + 1e-6)) + 1
        times = time - np.arange(max(frames, 1) - 1, -1, -1) / fps
        if not robot.is_canonical:
            return self._source_at(robot, times, fps)
        joints = np.array([self.joints(t)[0] for t in times])
        held = np.clip(times, 0.0, self.trajectory.duration)
        turn = self._turn(held).as_quat(scalar_first=True)
        return qpos_to_motion(np.concatenate([self._root(held), turn, joints], axis=1), fps)

    def _source_at(self, robot: Robot, times: Array, fps: float) -> Motion:
        source = self.trajectory.source
        if source is None:
            raise RobotError(f"robot '{robot.name}': its joints cannot be read back as a motion")
        return sample_at(source.motion, np.interp(times, self.trajectory.times, source.times), fps)
