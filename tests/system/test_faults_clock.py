"""Simulated time that does not come, jumps ahead, and runs back."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from builtin_interfaces.msg import Time
from ros_graph import ANSWER, FAST, START
from ros_plans import goal, ignore
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.msg import MotionPlan
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.ros.client import Feedback, MotionClient
from motiondiffuse_ros.ros.processes import ros_arguments, running
from motiondiffuse_ros.ros.qos import STREAM

pytestmark = pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)


class Timekeeper(MotionClient):
    """Publishes /clock, which stands still until it is set."""

    def __init__(self, alive) -> None:
        super().__init__(alive)
        self.stamp = -1
        self._clock = self.node.create_publisher(Clock, "/clock", 10)
        self.points: list[JointState] = []
        self.node.create_subscription(
            JointState, "/motiondiffuse/reference", self.points.append, STREAM
        )

    def set(self, seconds: int) -> None:
        """Set the clock and wait until the node goes by it."""
        self.wait(lambda: self._clock.get_subscription_count() > 0, ANSWER, "a reader of /clock")
        self._clock.publish(Clock(clock=Time(sec=seconds)))
        self.wait(lambda: self.stamp == seconds, ANSWER, "a node that has the time")

    def plan(self, seconds: float, **fields) -> MotionPlan:
        result = self.generate(goal("a person walks", seconds, **fields), ignore, ANSWER)
        assert result.error_code == ErrorCode.SUCCESS
        return result.plan

    def _on_health(self, message) -> None:
        super()._on_health(message)
        self.stamp = message.header.stamp.sec


@pytest.fixture
def keeper(graph) -> Iterator[Timekeeper]:
    log = graph / "node.log"
    arguments = ros_arguments(**FAST, use_sim_time=True)
    with (
        running("motiondiffuse_ros.ros.node", arguments, log) as process,
        Timekeeper(lambda: process.poll() is None) as keeper,
    ):
        keeper.wait_for_node(START)
        yield keeper
    assert "Traceback" not in log.read_text()


def test_a_clock_that_stands_still_jumps_ahead_and_runs_back(keeper):
    # no /clock yet: it has started, and works and cancels all the same
    assert keeper.plan(1.0).header.stamp.sec == 0
    begun: list[Feedback] = []
    active = keeper.send(goal("a person walks", 1.0, steps=1000), begun.append, ANSWER)
    keeper.wait(lambda: bool(begun), ANSWER, "feedback")  # or the next one may be begun first
    waiting = keeper.send(goal("a person walks", 1.0), ignore, ANSWER)
    for handle in (waiting, active):
        handle.cancel_goal_async()
        assert keeper.result(handle, ANSWER).error_code == ErrorCode.CANCELED

    keeper.set(1000)
    assert keeper.plan(30.0).header.stamp.sec == 1000

    # ahead, beyond the end of what is executed: the next plan starts there
    keeper.set(5000)
    assert 5000 <= keeper.plan(30.0).header.stamp.sec < 5030

    # back, while one plan is executed and the next is made
    feedback: list[Feedback] = []
    handle = keeper.send(goal("a person walks", 1.0, steps=300), feedback.append, ANSWER)
    keeper.wait(lambda: bool(feedback), ANSWER, "feedback")
    keeper.set(10)
    result = keeper.result(handle, ANSWER)
    assert result.error_code == ErrorCode.SUCCESS
    assert result.plan.header.stamp.sec == 10

    # and while one is executed and none is made
    keeper.plan(30.0)
    keeper.set(2)
    keeper.points.clear()
    plan = keeper.plan(1.0)
    assert plan.header.stamp.sec == 2
    keeper.set(3)
    last = list(plan.trajectory.points)[-1].positions

    def ended() -> bool:
        keeper._clock.publish(Clock(clock=Time(sec=8)))
        return bool(keeper.points) and list(keeper.points[-1].position) == list(last)

    keeper.wait(ended, ANSWER, "the last set-point")
