"""The state of a node on /diagnostics, and its last problem in one line."""

from __future__ import annotations

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from std_msgs.msg import Header

from motiondiffuse_ros.ros.steady import create_steady_timer

LEVELS = {
    "ok": DiagnosticStatus.OK,
    "warn": DiagnosticStatus.WARN,
    "error": DiagnosticStatus.ERROR,
}


def status(name: str, level: str, message: str, values: dict[str, object]) -> DiagnosticStatus:
    """Write one status; `level` is "ok", "warn" or "error"."""
    return DiagnosticStatus(
        level=LEVELS[level],
        name=name,
        message=message,
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )


REPEAT = 1.0
"""Period of the repetition [s]."""


class Diagnostics:
    """Publishes one status under a node's name, at every change and once a second."""

    def __init__(self, node: Node) -> None:
        """Create the publisher."""
        self._node = node
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._level, self._message = "ok", "starting"
        self._values: dict[str, object] = {}
        self._problems: dict[str, str] = {}
        self._timer = create_steady_timer(node, REPEAT, self.publish)

    def set(self, level: str, message: str, **values: object) -> None:
        """Replace level and message, add to the values, and publish at once."""
        self._level, self._message = level, message
        self._values |= values
        self.publish()

    def keep(self, what: str, problem: str) -> None:
        """Report a problem besides whatever is set, until it is replaced by none ("")."""
        if problem == self._problems.get(what, ""):
            return
        self._problems[what] = problem
        self._values[what] = problem or "ok"
        self.publish()

    def publish(self) -> None:
        """Publish the present status."""
        problems = [problem for problem in self._problems.values() if problem]
        level = "warn" if problems and self._level == "ok" else self._level
        message = "; ".join([self._message, *problems])
        name = self._node.get_fully_qualified_name().lstrip("/")
        self._publisher.publish(
            DiagnosticArray(
                header=Header(stamp=self._node.get_clock().now().to_msg()),
                status=[status(name, level, message, self._values)],
            )
        )
