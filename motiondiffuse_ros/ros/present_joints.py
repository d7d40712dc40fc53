"""Where the robot's joints are, as its driver says."""

from __future__ import annotations

import time

import numpy as np
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.lifecycle import LifecycleNode
from sensor_msgs.msg import JointState

from motiondiffuse_ros.robots import Robot, StartState
from motiondiffuse_ros.ros.qos import STREAM

FRESH = 1.0
"""Older messages say nothing about the present [s]."""


class PresentJoints:
    """Keeps the latest message of a topic of joint states."""

    def __init__(self, node: LifecycleNode, topic: str) -> None:
        """Subscribe; an empty topic is none."""
        self._node = node
        self._latest: tuple[JointState, float] | None = None
        self._subscription = None
        if topic:
            self._subscription = node.create_subscription(
                JointState,
                topic,
                self._keep,
                STREAM,
                callback_group=MutuallyExclusiveCallbackGroup(),
            )

    def state(self, robot: Robot) -> StartState | None:
        """Return a robot's joints; None, with a warning if there is a topic, if not known."""
        if self._subscription is None:
            return None
        topic, latest = self._subscription.topic_name, self._latest
        if latest is None or time.monotonic() - latest[1] > FRESH:
            self._warn(f"{topic}: nothing within {FRESH:g} s; the plan starts at its first pose")
            return None
        message = latest[0]
        place = {name: i for i, name in enumerate(message.name)}
        if missing := [name for name in robot.joint_names if name not in place]:
            self._warn(f"{topic}: no joint {missing[0]}; the plan starts at its first pose")
            return None
        index = [place[name] for name in robot.joint_names]
        positions = _values(message.position, index)
        if positions is None:
            self._warn(f"{topic}: positions are missing or not finite; they are not used")
            return None
        velocities = _values(message.velocity, index)
        return StartState(positions, 0.0 * positions if velocities is None else velocities)

    def destroy(self) -> None:
        """Remove the subscription from the node."""
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)

    def _keep(self, message: JointState) -> None:
        self._latest = (message, time.monotonic())

    def _warn(self, line: str) -> None:
        self._node.get_logger().warning(line)


def _values(given: object, index: list[int]) -> np.ndarray | None:
    values = np.asarray(given, dtype=float)
    if len(values) <= max(index) or not np.isfinite(values[index]).all():
        return None
    return values[index]
