"""The action: feedback, results, refusals, cancellation and queueing of the running node."""

import math

import numpy as np
import pytest
from rclpy.action.client import ClientGoalHandle
from ros_graph import ANSWER
from ros_plans import ignore
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.msg import MotionPlan, MotionRequest, MotionSegment, PlausibilityReport
from motiondiffuse_ros.robots import broken_promises, get_robot
from motiondiffuse_ros.ros.client import Feedback, MotionClient
from motiondiffuse_ros.ros.conversions import trajectory_from_messages
from motiondiffuse_ros.ros.qos import LATCHED, STREAM


def segment(text="a person walks forward", start=0.0, end=2.0, parts=()):
    return MotionSegment(text=text, start=start, end=end, parts=list(parts))


def request(*segments, **fields):
    return MotionRequest(segments=list(segments) or [segment()], **fields)


def first_text(plan: MotionPlan) -> str:
    return next(iter(plan.request.segments)).text


def answer(client: MotionClient, goal: MotionRequest):
    return client.generate(goal, ignore, ANSWER)


def test_a_goal_gives_feedback_and_a_plan_with_a_report(client):
    feedback: list[Feedback] = []
    result = client.generate(request(seed=3), feedback.append, ANSWER)
    assert (result.error_code, result.plan.seed) == (ErrorCode.SUCCESS, 3)
    fractions = [f.fraction for f in feedback]
    assert fractions == sorted(fractions)
    assert 0.0 <= fractions[0] <= fractions[-1] <= 1.0
    assert {"sampling", "physics", "retargeting"} <= {f.stage for f in feedback}
    assert sum(f.stage == "sampling" for f in feedback) >= 6

    plan = result.plan
    trajectory = trajectory_from_messages(plan.trajectory, plan.root_trajectory)
    assert broken_promises(trajectory, get_robot("humanoid")) == ()
    assert plan.duration == pytest.approx(trajectory.duration)
    assert len(plan.weights_sha256) == 64
    assert plan.total_time > 0.0

    report = plan.report
    verdicts = (
        PlausibilityReport.PLAUSIBLE,
        PlausibilityReport.MARGINAL,
        PlausibilityReport.IMPLAUSIBLE,
    )
    assert report.verdict in verdicts
    assert 0.0 <= report.score <= 1.0
    assert math.isfinite(report.skate_mm)
    assert [s.text for s in report.segments] == ["a person walks forward"]
    assert bool(report.reasons) == (report.verdict != PlausibilityReport.PLAUSIBLE)


def test_the_same_seed_gives_the_same_plan_and_another_seed_another(client):
    first, again, other = (
        np.array([p.positions for p in answer(client, request(seed=s)).plan.trajectory.points])
        for s in (5, 5, 6)
    )
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_timed_segments_on_body_parts_are_planned(client):
    goal = request(
        segment("a person walks forward", 0.0, 4.0),
        segment("waves the right hand", 1.0, 3.0, [MotionSegment.RIGHT_ARM]),
        duration=4.0,
    )
    result = answer(client, goal)
    assert result.error_code == ErrorCode.SUCCESS
    assert [list(s.parts) for s in result.plan.request.segments] == [[], ["right_arm"]]


BAD = {
    "no segments": (MotionRequest(), "no segments"),
    "empty text": (request(segment("")), "segment 1: the text is empty"),
    "blank text": (request(segment(" \t\n")), "segment 1: the text is empty"),
    "no words": (request(segment("... !!! 123")), "has no words"),
    "over-long text": (request(segment("walk " * 1000)), "5000 characters"),
    "unknown part": (request(segment(parts=["tail"])), "unknown body part 'tail'"),
    "unknown robot": (request(robot="robby"), "unknown robot 'robby'"),
    "negative time": (request(segment(start=-1.0)), "start is -1.0"),
    "not a number": (request(segment(end=math.nan)), "end is nan"),
    "infinite time": (request(segment(end=math.inf)), "end is inf"),
    "reversed times": (request(segment(start=3.0, end=1.0)), "not after its start"),
    "over the limit": (request(segment(end=1e6)), "the longest motion"),
    "too short": (request(segment(end=0.1)), "at least 0.5"),
    "overlap on one part": (
        request(segment(end=4.0), segment("a person bows", 2.0, 6.0)),
        "segments 1 and 2 overlap",
    ),
    "ends after the motion": (request(segment(end=4.0), duration=2.0), "after the motion's 2 s"),
    "duration not a number": (request(duration=math.nan), "duration"),
    "negative seed": (request(seed=-2), "seed is -2"),
    "too many steps": (request(steps=10**6), "steps"),
    "too many candidates": (request(candidates=10**6), "candidates"),
    "negative guidance": (request(guidance_scale=-1.0), "guidance_scale"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_goal_is_refused_with_one_line_before_any_work(client, name):
    goal, words = BAD[name]
    feedback: list[Feedback] = []
    result = client.generate(goal, feedback.append, ANSWER)
    expected = ErrorCode.INVALID_ROBOT if "robot" in name else ErrorCode.INVALID_REQUEST
    assert result.error_code == expected
    assert words in result.message
    assert "\n" not in result.message
    assert feedback == []
    assert not result.plan.trajectory.points


def test_after_bad_goals_a_good_one_works(client):
    for goal, _ in (BAD["empty text"], BAD["unknown robot"], BAD["not a number"]):
        assert answer(client, goal).error_code != ErrorCode.SUCCESS
    assert answer(client, request()).error_code == ErrorCode.SUCCESS


def test_bad_input_on_topics_is_logged_in_one_line_and_the_next_sentence_works(client, node):
    plans: list[MotionPlan] = []
    client.node.create_subscription(MotionPlan, "/motiondiffuse/plan", plans.append, LATCHED)
    text = client.node.create_publisher(String, "/motiondiffuse/text", 10)
    requests = client.node.create_publisher(MotionRequest, "/motiondiffuse/request", 10)
    client.wait(
        lambda: text.get_subscription_count() > 0 and requests.get_subscription_count() > 0,
        ANSWER,
        "the inputs",
    )
    requests.publish(BAD["unknown part"][0])
    text.publish(String(data="   "))
    text.publish(String(data="a person bows"))

    def planned() -> bool:
        return bool(plans) and first_text(plans[-1]) == "a person bows"

    client.wait(planned, ANSWER, "the plan")
    log = node.read_text()
    assert log.count("~/request: segment 1: unknown body part 'tail'") == 1
    assert log.count("~/text: segment 1: the text is empty") == 1
    assert "Traceback" not in log


def wait_for_feedback(client: MotionClient, goal: MotionRequest) -> ClientGoalHandle:
    """Send a goal and return its handle once the node works on it."""
    feedback: list[Feedback] = []
    handle = client.send(goal, feedback.append, ANSWER)
    client.wait(lambda: bool(feedback), ANSWER, "feedback")
    return handle


LONG = request(steps=1000, seed=1)


def test_cancelling_ends_a_goal_and_the_next_one_works(client):
    handle = wait_for_feedback(client, LONG)
    handle.cancel_goal_async()
    result = client.result(handle, ANSWER)
    assert result.error_code == ErrorCode.CANCELED
    assert not result.plan.trajectory.points
    assert answer(client, request()).error_code == ErrorCode.SUCCESS


def test_a_newer_goal_replaces_the_one_that_waits_and_not_the_one_in_work(client):
    active = wait_for_feedback(client, LONG)
    waiting = client.send(request(segment("a person bows")), ignore, ANSWER)
    newest = client.send(request(segment("a person runs")), ignore, ANSWER)
    result = client.result(waiting, ANSWER)
    assert result.error_code == ErrorCode.SUPERSEDED
    assert "newer request" in result.message
    active.cancel_goal_async()
    assert client.result(active, ANSWER).error_code == ErrorCode.CANCELED
    assert first_text(client.result(newest, ANSWER).plan) == "a person runs"


def test_a_waiting_goal_can_be_cancelled_while_another_is_in_work(client):
    active = wait_for_feedback(client, LONG)
    waiting = client.send(request(segment("a person bows")), ignore, ANSWER)
    waiting.cancel_goal_async()
    assert client.result(waiting, ANSWER).error_code == ErrorCode.CANCELED
    active.cancel_goal_async()
    assert client.result(active, ANSWER).error_code == ErrorCode.CANCELED


def test_who_joins_late_gets_the_last_plan(client):
    result = answer(client, request(seed=11))
    plans: list[MotionPlan] = []
    with MotionClient() as late:
        late.node.create_subscription(MotionPlan, "/motiondiffuse/plan", plans.append, LATCHED)
        late.wait(lambda: bool(plans), ANSWER, "the latched plan")
    assert plans[0].plan_id == result.plan.plan_id
    assert plans[0].trajectory == result.plan.trajectory


def test_set_points_follow_a_plan_from_its_start_to_rest(client):
    points: list[JointState] = []
    client.node.create_subscription(JointState, "/motiondiffuse/reference", points.append, STREAM)
    plan = answer(client, request(segment(end=1.0), seed=2)).plan
    last = list(plan.trajectory.points)[-1].positions

    def ended() -> bool:
        return bool(points) and np.allclose(points[-1].position, last, atol=1e-12)

    client.wait(ended, ANSWER, "the last set-point")
    assert list(points[-1].name) == list(plan.trajectory.joint_names)
    assert not np.any(points[-1].velocity)
    positions = np.array([p.position for p in points])
    robot = get_robot("humanoid")
    assert (positions >= robot.lower - 0.05).all()
    assert (positions <= robot.upper + 0.05).all()
