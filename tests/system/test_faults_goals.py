"""Goals that are cancelled, overtaken, sent by the thousand or left alone, on one node."""

from __future__ import annotations

import random
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from rclpy.context import Context
from rclpy.node import Node
from ros_graph import ANSWER, FAST, START, own_graph
from ros_operator import Operator
from ros_plans import ignore

from benchmarks.soak import resident_bytes
from motiondiffuse_ros.action import GenerateMotion
from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.msg import MotionPlan, MotionRequest, MotionSegment
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.ros.client import Feedback
from motiondiffuse_ros.ros.processes import ros_arguments, running
from motiondiffuse_ros.ros.qos import LATCHED

pytestmark = pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)

ENDS = {
    ErrorCode.SUCCESS: GoalStatus.STATUS_SUCCEEDED,
    ErrorCode.CANCELED: GoalStatus.STATUS_CANCELED,
    ErrorCode.SUPERSEDED: GoalStatus.STATUS_ABORTED,
}
"""The terminal state of the action that belongs to a code."""


@pytest.fixture(scope="module")
def node(tmp_path_factory) -> Iterator[subprocess.Popen[bytes]]:
    with own_graph(tmp_path_factory.mktemp("faults")) as folder:
        arguments = ros_arguments(**FAST, continuity=False)
        log = folder / "node.log"
        with running("motiondiffuse_ros.ros.node", arguments, log) as process:
            yield process
        assert process.returncode == 0
        assert "Traceback" not in log.read_text()


@pytest.fixture
def operator(node) -> Iterator[Operator]:
    with Operator(lambda: node.poll() is None) as operator:
        operator.wait_for_node(START)
        yield operator


def goal(text="a person walks", **fields):
    return MotionRequest(segments=[MotionSegment(text=text, start=0.0, end=0.6)], **fields)


class Sent:
    """A goal on its way."""

    def __init__(self, operator: Operator, request: MotionRequest) -> None:
        self._operator = operator
        self._feedback: list[Feedback] = []
        self.handle = operator.send(request, self._feedback.append, ANSWER)
        self._result = self.handle.get_result_async()

    def reach(self, steps: int) -> None:
        """Wait until it has been told of so many steps, or has ended."""
        self._operator.wait(
            lambda: len(self._feedback) >= steps or self._result.done(), ANSWER, "feedback"
        )

    def end(self) -> ErrorCode:
        """Wait for its result, whose code and terminal state have to agree."""
        self._operator.wait(self._result.done, ANSWER, "the result")
        answer = self._result.result()
        assert answer is not None
        code = ErrorCode(answer.result.error_code)
        assert answer.status == ENDS[code]
        assert answer.result.message
        assert bool(answer.result.plan.trajectory.points) == (code is ErrorCode.SUCCESS)
        return code


def test_a_hundred_goals_cancelled_at_random_times(operator):
    ends: Counter[ErrorCode] = Counter()
    when = random.Random(1)
    for _ in range(100):
        sent = Sent(operator, goal(steps=30))
        sent.reach(when.randint(0, 15))
        sent.handle.cancel_goal_async()
        ends[sent.end()] += 1
    assert set(ends) <= {ErrorCode.CANCELED, ErrorCode.SUCCESS}
    assert ends[ErrorCode.CANCELED] > 50
    assert operator.generate(goal(), ignore, ANSWER).error_code == ErrorCode.SUCCESS


def test_fifty_goals_preempted_at_random_times(operator):
    assert operator.set("preempt", True) == ""
    when = random.Random(2)
    sent = []
    for _ in range(51):
        sent.append(Sent(operator, goal(steps=30)))
        sent[-1].reach(when.randint(0, 12))
    ends = Counter(one.end() for one in sent)
    assert operator.set("preempt", False) == ""
    assert sent[-1].end() is ErrorCode.SUCCESS
    assert set(ends) <= {ErrorCode.SUPERSEDED, ErrorCode.SUCCESS}
    assert ends[ErrorCode.SUPERSEDED] > 25


def test_a_thousand_goals_at_once_all_end_in_bounded_memory(operator, node):
    before = resident_bytes(node.pid)
    accepted = [
        operator.action.send_goal_async(GenerateMotion.Goal(request=goal())) for _ in range(1000)
    ]
    operator.wait(lambda: all(one.done() for one in accepted), ANSWER, "answers to all goals")
    results = [one.result().get_result_async() for one in accepted]
    operator.wait(lambda: all(one.done() for one in results), ANSWER, "all results")
    ends = Counter(ErrorCode(one.result().result.error_code) for one in results)
    assert ends.total() == 1000
    assert set(ends) <= {ErrorCode.SUPERSEDED, ErrorCode.SUCCESS}
    # goals are queued in the order in which they came, so the newest is what is planned at last
    assert results[-1].result().result.error_code == ErrorCode.SUCCESS
    assert resident_bytes(node.pid) - before < 200e6
    assert operator.generate(goal(), ignore, ANSWER).error_code == ErrorCode.SUCCESS


def test_a_client_that_is_killed_leaves_nothing_stuck(operator):
    script = Path(__file__).with_name("killed_client.py")
    with subprocess.Popen(
        [sys.executable, str(script)], stdout=subprocess.PIPE, text=True
    ) as client:
        assert client.stdout is not None
        assert client.stdout.readline()
        client.kill()
    assert operator.generate(goal(), ignore, ANSWER).error_code == ErrorCode.SUCCESS


def test_a_subscriber_that_never_reads_holds_nobody_up(operator):
    context = Context()
    rclpy.init(context=context)
    sleeper = Node("sleeper", context=context)
    taken: list[MotionPlan] = []
    sleeper.create_subscription(MotionPlan, "/motiondiffuse/plan", taken.append, LATCHED)
    operator.wait(
        lambda: operator.node.count_subscribers("/motiondiffuse/plan") > 0, ANSWER, "the sleeper"
    )
    for _ in range(10):
        assert operator.generate(goal(), ignore, ANSWER).error_code == ErrorCode.SUCCESS
    assert taken == []
    sleeper.destroy_node()
    rclpy.try_shutdown(context=context)


def test_a_plan_whose_files_cannot_be_written_is_a_plan_all_the_same(operator):
    assert operator.set("plan_dir", "/dev/null/plans") == ""
    assert operator.generate(goal(), ignore, ANSWER).error_code == ErrorCode.SUCCESS
    assert operator.set("plan_dir", "") == ""
