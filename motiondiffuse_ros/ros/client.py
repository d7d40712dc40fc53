"""A client of the `motiondiffuse` node in plain, blocking calls."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType
from typing import TypeVar

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.action.client import ActionClient, ClientGoalHandle
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from motiondiffuse_ros.action import GenerateMotion
from motiondiffuse_ros.msg import MotionRequest
from motiondiffuse_ros.ros.qos import GOALS, LATCHED

Feedback = GenerateMotion.Feedback
Alive = Callable[[], bool]


AnyClient = TypeVar("AnyClient", bound="MotionClient")


class Unreachable(Exception):
    """The other side did not answer in time, or is gone."""


class NotConfigured(Exception):
    """The node could not load its weights or robot; the message is its own."""


class MotionClient:
    """Sends goals and waits for what comes of them, in an rclpy context of its own."""

    def __init__(self, alive: Alive = lambda: True) -> None:
        """Join the ROS graph.

        Args:
            alive: Whether waiting still makes sense; asked several times a second.
        """
        self._alive = alive
        self._context = Context()
        rclpy.init(context=self._context)
        self.node = Node("motiondiffuse_client", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self.action = ActionClient(
            self.node,
            GenerateMotion,
            "motiondiffuse/generate_motion",
            goal_service_qos_profile=GOALS,
            result_service_qos_profile=GOALS,
        )
        self._execution = DiagnosticStatus()
        self.health = DiagnosticStatus()
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self._on_health, 10)
        self.node.create_subscription(
            DiagnosticStatus, "sim/execution", self._on_execution, LATCHED
        )

    def __enter__(self: AnyClient) -> AnyClient:
        """Return itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the ROS graph."""
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def wait(self, done: Callable[[], bool], timeout: float, what: str) -> None:
        """Handle ROS events until something is done, for at most `timeout` seconds.

        Raises:
            Unreachable: If it is not done in time, or a process has ended.
        """
        deadline = time.monotonic() + timeout
        while not done():
            if not self._alive():
                raise Unreachable(f"a process ended while waiting for {what}")
            if time.monotonic() > deadline:
                raise Unreachable(f"no sign of {what} for {timeout:g} s")
            self._executor.spin_once(timeout_sec=0.1)

    def spin(self, seconds: float) -> None:
        """Handle the next ROS event that comes within `seconds`."""
        self._executor.spin_once(timeout_sec=seconds)

    @property
    def heard(self) -> bool:
        """Whether the node has said how it is.

        Then it has met this client, too: it can be seen seconds before, and what it answers until
        then is lost.
        """
        return bool(self.health.name)

    def wait_for_node(self, timeout: float) -> None:
        """Wait until the node takes goals, for at most `timeout` seconds.

        Raises:
            NotConfigured: If it says that it cannot.
            Unreachable: If there is no sign of it.
        """

        def answered() -> bool:
            failed = self.health.level == DiagnosticStatus.ERROR
            return failed or (self.heard and self.action.server_is_ready())

        self.wait(answered, timeout, "the node motiondiffuse")
        if not self.action.server_is_ready():
            raise NotConfigured(self.health.message)

    def generate(
        self, request: MotionRequest, on_feedback: Callable[[Feedback], None], timeout: float
    ) -> GenerateMotion.Result:
        """Send a goal and wait for its result, for at most `timeout` seconds.

        Raises:
            Unreachable: If there is no result in time.
        """
        return self.result(self.send(request, on_feedback, timeout), timeout)

    def send(
        self, request: MotionRequest, on_feedback: Callable[[Feedback], None], timeout: float
    ) -> ClientGoalHandle:
        """Send a goal and return its handle, once the node has it.

        Raises:
            Unreachable: If the node does not answer within `timeout` seconds.
        """
        accepted = self.action.send_goal_async(
            GenerateMotion.Goal(request=request),
            feedback_callback=lambda message: on_feedback(message.feedback),
        )
        self.wait(accepted.done, timeout, "an answer to the goal")
        handle = accepted.result()
        assert handle is not None
        return handle

    def result(self, handle: ClientGoalHandle, timeout: float) -> GenerateMotion.Result:
        """Wait for the result of a goal, for at most `timeout` seconds.

        Raises:
            Unreachable: If there is none in time.
        """
        result = handle.get_result_async()
        self.wait(result.done, timeout, "the result")
        answer = result.result()
        assert answer is not None
        return answer.result

    def wait_for_execution(
        self, stamp: str, on_status: Callable[[DiagnosticStatus], None], timeout: float
    ) -> dict[str, str]:
        """Wait until the sim has followed the trajectory of a stamp.

        Returns:
            The values of `sim/execution`.

        Raises:
            Unreachable: If it has not after `timeout` seconds.
        """

        def values() -> dict[str, str]:
            return {item.key: item.value for item in self._execution.values}

        def finished() -> bool:
            if values().get("stamp") != stamp:
                return False
            on_status(self._execution)
            return self._execution.message == "finished"

        self.wait(finished, timeout, "the end of the execution")
        return values()

    def _on_health(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name.rpartition("/")[2] == "motiondiffuse":
                self.health = status

    def _on_execution(self, message: DiagnosticStatus) -> None:
        self._execution = message
