"""A long motion is executed while its later pieces are still being sampled."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from ros_graph import ANSWER, FAST, START
from ros_plans import goal, ignore, seconds, states
from sensor_msgs.msg import JointState

from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.msg import MotionPlan
from motiondiffuse_ros.recording import difference, planner_of, read_recording, replay
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.ros.client import MotionClient
from motiondiffuse_ros.ros.processes import ros_arguments, running
from motiondiffuse_ros.ros.qos import LATCHED, STREAM

ROBOT = get_robot("humanoid")


@pytest.fixture
def client(graph) -> Iterator[MotionClient]:
    """A client of a node that plans three seconds at a time."""
    settings = {**FAST, "track": True, "horizon": 3.0}
    arguments = ros_arguments(**settings, record_dir=graph / "recordings")
    with (
        running("motiondiffuse_ros.ros.node", arguments, graph / "node.log") as process,
        MotionClient(lambda: process.poll() is None) as client,
    ):
        client.wait_for_node(START)
        yield client


def test_pieces_follow_one_another_without_a_jump(client, graph):
    pieces: list[MotionPlan] = []
    points: list[JointState] = []
    client.node.create_subscription(MotionPlan, "/motiondiffuse/plan", pieces.append, LATCHED)
    client.node.create_subscription(JointState, "/motiondiffuse/reference", points.append, STREAM)
    fractions: list[float] = []
    result = client.generate(
        goal("a person walks forward", 9.0, seed=3),
        lambda feedback: fractions.append(feedback.fraction),
        ANSWER,
    )
    assert result.error_code == ErrorCode.SUCCESS
    client.wait(lambda: len(pieces) == 3, ANSWER, "three plans")
    assert fractions == sorted(fractions)

    whole = states(result.plan)[0]
    began = seconds(result.plan.header.stamp)
    assert began == seconds(pieces[0].header.stamp)
    assert [plan.request.seed for plan in pieces] == [3, 4, 5]
    # nobody waits for the simulation of a piece
    assert np.isnan([plan.report.time_to_fall_s for plan in pieces]).all()
    assert result.plan.report.time_to_fall_s > 0.0
    for old, new in pairwise(pieces):
        seam = seconds(new.header.stamp) - seconds(old.header.stamp)
        here, there = states(old)[0].at(seam), states(new)[0].at(0.0)
        assert seam >= 3.0 - 1e-6
        np.testing.assert_allclose(there.positions, here.positions, atol=1e-4)
        np.testing.assert_allclose(there.velocities, here.velocities, atol=1e-4)
        assert here.root is not None
        assert there.root is not None
        np.testing.assert_allclose(there.root.position, here.root.position, atol=0.01)

    client.wait(
        lambda: (
            bool(points)
            and np.allclose(points[-1].position, whole.trajectory.positions[-1], atol=1e-9)
        ),
        ANSWER,
        "the last set-point",
    )
    for point in points:
        asked = whole.at(seconds(point.header.stamp) - began)
        assert np.abs(np.degrees(asked.positions - point.position)).max() < 1.0

    recorded = {path.stem.partition("_")[2]: path for path in (graph / "recordings").iterdir()}
    joined = f"{pieces[0].plan_id}_whole"
    assert set(recorded) == {joined, *(plan.plan_id for plan in pieces)}
    record = read_recording(recorded[joined])
    np.testing.assert_array_equal(record.trajectory["positions"], whole.trajectory.positions)
    # in another process than the node's
    assert difference(record, replay(record, planner_of(record)).trajectory) == ""


@pytest.mark.parametrize(("few_steps", "steps"), [(True, [5, 8]), (False, [8, 8])])
def test_the_first_piece_takes_few_steps_unless_told_otherwise(graph, few_steps, steps):
    settings = {**FAST, "steps": 8, "horizon": 3.0, "few_steps": few_steps}
    log = graph / "node.log"
    with (
        running("motiondiffuse_ros.ros.node", ros_arguments(**settings), log) as process,
        MotionClient(lambda: process.poll() is None) as client,
    ):
        client.wait_for_node(START)
        plans: list[MotionPlan] = []
        client.node.create_subscription(MotionPlan, "/motiondiffuse/plan", plans.append, LATCHED)
        result = client.generate(goal("a person walks forward", 6.0), ignore, ANSWER)
        assert result.error_code == ErrorCode.SUCCESS
        client.wait(lambda: len(plans) == 2, ANSWER, "two plans")
        assert [plan.request.steps for plan in plans] == steps


def test_a_new_text_takes_over_from_the_piece_that_runs(client):
    plans: list[MotionPlan] = []
    client.node.create_subscription(MotionPlan, "/motiondiffuse/plan", plans.append, LATCHED)
    handle = client.send(goal("a person walks forward", 120.0), ignore, ANSWER)
    client.wait(lambda: len(plans) >= 2, ANSWER, "the second piece")
    newer = client.generate(goal("a person waves", 2.0), ignore, ANSWER)
    assert newer.error_code == ErrorCode.SUCCESS
    assert client.result(handle, ANSWER).error_code == ErrorCode.SUPERSEDED

    taken_over = seconds(newer.plan.header.stamp)
    older = [plan for plan in plans if seconds(plan.header.stamp) < taken_over]
    running = older[-1]
    here = states(running)[0].at(taken_over - seconds(running.header.stamp))
    there = states(newer.plan)[0].at(0.0)
    np.testing.assert_allclose(there.positions, here.positions, atol=1e-4)
    np.testing.assert_allclose(there.velocities, here.velocities, atol=1e-4)
