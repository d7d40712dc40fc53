"""Set-points at the control rate, from the moment a plan is published."""

from __future__ import annotations

from array import array

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.lifecycle import LifecycleNode
from rclpy.time import Time
from scipy.interpolate import CubicHermiteSpline
from sensor_msgs.msg import JointState

from motiondiffuse_ros.robots.trajectory import JointTrajectory
from motiondiffuse_ros.ros.qos import STREAM


class ReferenceStream:
    """Publishes `~/reference`: the joints that a plan asks for now, until it has ended."""

    def __init__(self, node: LifecycleNode, rate: float) -> None:
        """Create publisher and timer.

        Args:
            node: Whose clock counts.
            rate: Set-points a second [Hz].
        """
        self._node = node
        self._publisher = node.create_lifecycle_publisher(JointState, "~/reference", STREAM)
        self._current: tuple[JointTrajectory, CubicHermiteSpline, Time] | None = None
        self._timer = node.create_timer(
            1.0 / rate, self._publish, MutuallyExclusiveCallbackGroup(), autostart=False
        )

    def start(self, trajectory: JointTrajectory) -> None:
        """Stream a trajectory from now on, in place of any other."""
        path = CubicHermiteSpline(trajectory.times, trajectory.positions, trajectory.velocities)
        self._current = (trajectory, path, self._node.get_clock().now())
        self._timer.reset()

    def stop(self) -> None:
        """Stop streaming."""
        self._current = None
        self._timer.cancel()

    def destroy(self) -> None:
        """Remove publisher and timer from the node."""
        self.stop()
        self._node.destroy_timer(self._timer)
        self._node.destroy_lifecycle_publisher(self._publisher)

    def _publish(self) -> None:
        # start() may replace it at any time from the planning thread
        current = self._current
        if current is None:
            return
        trajectory, path, start = current
        now = self._node.get_clock().now()
        elapsed = (now - start).nanoseconds * 1e-9
        message = JointState(name=list(trajectory.joint_names))
        message.header.stamp = now.to_msg()
        if elapsed < trajectory.duration:
            message.position = array("d", path(elapsed))
            message.velocity = array("d", path(elapsed, 1))
        else:  # exactly at rest, without a spline's rounding
            message.position = array("d", trajectory.positions[-1])
            message.velocity = array("d", trajectory.velocities[-1])
            if self._current is current:
                self.stop()
        self._publisher.publish(message)
