"""The node `sim`: a robot in MuJoCo that does what the `motiondiffuse` node publishes."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory, MultiDOFJointTrajectory

from motiondiffuse_ros.errors import MotionDiffuseError, PhysicsError
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.robots.simulation import SimulatedRobot, SimulationConfig
from motiondiffuse_ros.ros.conversions.trajectory import trajectory_from_messages
from motiondiffuse_ros.ros.execution_status import ExecutionStatus
from motiondiffuse_ros.ros.parameter_spec import Parameters
from motiondiffuse_ros.ros.qos import LATCHED
from motiondiffuse_ros.ros.sim_parameters import SIM_PARAMETERS
from motiondiffuse_ros.ros.spinning import run_node
from motiondiffuse_ros.ros.state_publisher import StatePublisher

LONGEST_CATCH_UP = 0.1
"""Simulated time that one tick may have to make up for; a slow machine falls behind instead [s]."""


class SimNode(Node):
    """Follows `motiondiffuse/joint_trajectory` and `motiondiffuse/root_trajectory`.

    Publishes `joint_states`, `odom`, /clock, /tf (where tf2_msgs is installed) and `~/execution`.
    With `root` "assisted" an outside force holds the floating base on its path; "free" leaves
    balance to the joints.
    """

    def __init__(self) -> None:
        """Declare the parameters and put the robot upright."""
        super().__init__("sim")
        settings = Parameters(self, SIM_PARAMETERS)
        self._factor: float = settings["real_time_factor"]
        self._record = Path(settings["record"]) if settings["record"] else None
        self._robot = SimulatedRobot(
            get_robot(settings["robot"]),
            SimulationConfig(
                assisted=settings["root"] == "assisted", approach_s=settings["approach_seconds"]
            ),
        )
        self._joints: JointTrajectory | None = None
        self._root: MultiDOFJointTrajectory | None = None
        self.create_subscription(
            JointTrajectory,
            "motiondiffuse/joint_trajectory",
            self._on_joints,
            LATCHED,
        )
        self.create_subscription(
            MultiDOFJointTrajectory,
            "motiondiffuse/root_trajectory",
            self._on_root,
            LATCHED,
        )
        self._state = StatePublisher(self, self._robot)
        self._execution = ExecutionStatus(self, self._robot)
        self._viewer = _open_window(self, self._robot) if settings["window"] else None
        # /clock is what this node makes, so its own timer runs on the machine's clock
        self._last = time.monotonic()
        self.create_timer(
            1.0 / settings["publish_rate"],
            self._tick,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        how = "held on its path by an outside force" if self._robot.config.assisted else "free"
        self.get_logger().info(f"{settings['robot']} stands; its root is {how}")

    def _on_joints(self, message: JointTrajectory) -> None:
        self._joints = message
        self._follow_when_complete()

    def _on_root(self, message: MultiDOFJointTrajectory) -> None:
        self._root = message
        self._follow_when_complete()

    def _follow_when_complete(self) -> None:
        """Start once both halves of one plan are here."""
        joints, root = self._joints, self._root
        if joints is None or root is None or joints.header.stamp != root.header.stamp:
            return
        self._joints = self._root = None
        try:
            self._robot.follow(trajectory_from_messages(joints, root))
        except MotionDiffuseError as error:
            self.get_logger().error(f"trajectory refused: {error}")
            return
        self._execution.begin(joints.header.stamp)

    def _tick(self) -> None:
        now = time.monotonic()
        due = min((now - self._last) * self._factor, LONGEST_CATCH_UP)
        self._last = now
        self._advance(self._robot.time + due)
        self._state.publish()
        if self._viewer is not None and self._viewer.is_running():
            self._viewer.sync()

    def _advance(self, until: float) -> None:
        before = self._robot.state
        try:
            while self._robot.time < until:
                self._robot.step()
        except PhysicsError as error:
            self.get_logger().error(str(error))
        if self._robot.state != before:
            self._on_change()

    def _on_change(self) -> None:
        if self._robot.state == "finished" and self._record is not None:
            try:
                self._robot.executed().save_npz(self._record)
            except OSError as error:
                self.get_logger().error(f"not recorded: {error}")
        self._execution.publish()
        self.get_logger().info(self._execution.summary())


def _open_window(node: Node, robot: SimulatedRobot) -> Any:
    """Return MuJoCo's viewer, or None with a warning where there is no display."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        node.get_logger().warning("no window: there is no display")
        return None
    import mujoco.viewer

    return mujoco.viewer.launch_passive(robot.model, robot.data)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node; returns the exit code."""
    return run_node(SimNode, args, threads=1)


if __name__ == "__main__":
    sys.exit(main())
