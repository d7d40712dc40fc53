"""Set-points at the control rate, from the moment a plan begins."""

from __future__ import annotations

from array import array
from dataclasses import dataclass

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.lifecycle import LifecycleNode
from rclpy.time import Time
from sensor_msgs.msg import JointState

from motiondiffuse_ros.robots.trajectory import JointTrajectory
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState
from motiondiffuse_ros.ros.qos import STREAM

BACKWARD = 0.1
"""A clock that runs back by more, such as that of a simulation reset, ends what is streamed [s]."""


@dataclass(frozen=True, eq=False)
class Playing:
    """A trajectory and when it begins.

    Attributes:
        states: The trajectory.
        start: Of its first point.
        before: What is streamed until then.
    """

    states: TrajectoryState
    start: Time
    before: Playing | None = None

    def elapsed(self, now: Time) -> float:
        """Return the time since the first point [s]; negative before it."""
        return (now - self.start).nanoseconds * 1e-9

    def at(self, now: Time) -> Playing:
        """Return what is streamed at a time: this, or what came before."""
        playing = self
        while playing.before is not None and playing.elapsed(now) < 0.0:
            playing = playing.before
        return playing

    def until(self, end: Time, now: Time) -> Playing:
        """Return what is left if something else takes over: neither past nor what begins later."""
        playing = self
        while playing.before is not None and playing.elapsed(end) <= 0.0:
            playing = playing.before
        if playing.before is None or playing.elapsed(now) >= 0.0:
            return Playing(playing.states, playing.start)
        return Playing(playing.states, playing.start, playing.before.until(playing.start, now))


class ReferenceStream:
    """Publishes `~/reference`: the joints that a plan asks for now, until it has ended.

    Attributes:
        resets: How often the clock ran back or was changed for another.
    """

    def __init__(self, node: LifecycleNode, rate: float) -> None:
        """Create publisher and timer.

        Args:
            node: Whose clock counts.
            rate: Set-points a second [Hz].
        """
        self._node = node
        self._publisher = node.create_lifecycle_publisher(JointState, "~/reference", STREAM)
        self._current: Playing | None = None
        self._timer = node.create_timer(
            1.0 / rate, self._publish, MutuallyExclusiveCallbackGroup(), autostart=False
        )
        self.resets = 0
        self._resets = node.get_clock().create_jump_callback(
            JumpThreshold(
                min_forward=None, min_backward=Duration(nanoseconds=-round(BACKWARD * 1e9))
            ),
            post_callback=self._on_reset,
        )

    @property
    def playing(self) -> Playing | None:
        """What is streamed, or about to be; None once it has come to its end."""
        return self._current

    def start(self, trajectory: JointTrajectory, at: Time) -> None:
        """Stream a trajectory in place of any other.

        Args:
            trajectory: What to stream.
            at: When its first point is due; those before it go on until then.
        """
        current = self._current
        before = None if current is None else current.until(at, self._node.get_clock().now())
        self._current = Playing(TrajectoryState(trajectory), at, before)
        if current is None:  # the timer's first call is a period away
            self._publish()
        self._timer.reset()

    def forget_what_follows(self) -> None:
        """Let what is streamed now come to its own end; what was to take over does not."""
        current = self._current
        if current is not None:
            playing = current.at(self._node.get_clock().now())
            self._current = Playing(playing.states, playing.start)

    def stop(self) -> None:
        """Stop streaming."""
        self._current = None
        self._timer.cancel()

    def destroy(self) -> None:
        """Remove publisher and timer from the node."""
        self.stop()
        self._resets.unregister()
        self._node.destroy_timer(self._timer)
        self._node.destroy_lifecycle_publisher(self._publisher)

    def _on_reset(self, jump: TimeJump) -> None:
        # stamps of before say nothing about times to come
        self.resets += 1
        self.stop()

    def _publish(self) -> None:
        # start() may replace it at any time from the planning thread
        current = self._current
        if current is None:
            return
        now = self._node.get_clock().now()
        playing = current.at(now)
        elapsed = playing.elapsed(now)
        positions, velocities = playing.states.joints(elapsed)
        message = JointState(name=list(playing.states.trajectory.joint_names))
        message.header.stamp = now.to_msg()
        message.position = array("d", positions)
        message.velocity = array("d", velocities)
        ended = elapsed >= playing.states.trajectory.duration
        if ended and playing is current and self._current is current:
            self.stop()
        self._publisher.publish(message)
