"""How far a simulated robot is with the trajectory it was given, on `~/execution`."""

from __future__ import annotations

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.node import Node

from motiondiffuse_ros.robots.simulation import SimulatedRobot
from motiondiffuse_ros.ros.diagnostics import status
from motiondiffuse_ros.ros.qos import LATCHED


class ExecutionStatus:
    """Publishes a DiagnosticStatus at every change of state; the last is kept for late joiners.

    `message` is the state: waiting, approaching, following or finished. Values: `stamp` of the
    trajectory (seconds.nanoseconds), `root` (assisted or free), `fallen`, and once finished the
    errors and the size of the assistance.
    """

    def __init__(self, node: Node, robot: SimulatedRobot) -> None:
        """Create the publisher and say that the robot waits."""
        self._robot = robot
        self._stamp = ""
        self._publisher = node.create_publisher(DiagnosticStatus, "~/execution", LATCHED)
        self.publish()

    def begin(self, stamp: Time) -> None:
        """Note which trajectory it is about."""
        self._stamp = stamp_key(stamp)
        self.publish()

    def publish(self) -> None:
        """Publish the present state."""
        level = "warn" if self._robot.fallen else "ok"
        self._publisher.publish(status("execution", level, self._robot.state, self._values()))

    def summary(self) -> str:
        """Return the state in one line."""
        values = ", ".join(f"{key} {value}" for key, value in self._values().items())
        return f"{self._robot.state}: {values}"

    def _values(self) -> dict[str, object]:
        robot = self._robot
        values: dict[str, object] = {
            "stamp": self._stamp,
            "root": "assisted" if robot.config.assisted else "free",
            "fallen": robot.fallen,
        }
        if robot.state == "finished":
            executed = robot.executed()
            values |= {
                "joint_error_rad": f"{executed.joint_error:.4f}",
                "root_error_m": f"{executed.root_error:.4f}",
                "assistance_body_weights": f"{executed.assistance.mean():.3f}",
            }
        return values


def stamp_key(stamp: Time) -> str:
    """Return a stamp as text, to tell trajectories apart."""
    return f"{stamp.sec}.{stamp.nanosec:09d}"
