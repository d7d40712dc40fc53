"""Timers that go on when simulated time stands still, jumps or was never published."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.timer import Timer


def create_steady_timer(node: Node, period: float, callback: Callable[[], None]) -> Timer:
    """Create a timer in a group of its own.

    Args:
        node: Owner.
        period: On the machine's monotonic clock [s].
        callback: Called every time.
    """
    return node.create_timer(
        period,
        callback,
        MutuallyExclusiveCallbackGroup(),
        clock=Clock(clock_type=ClockType.STEADY_TIME),
    )
