"""Goals sent while a plan is executed: the set-points go on without a jump."""

from collections.abc import Iterator

import numpy as np
import pytest
from ros_graph import ANSWER, FAST, START
from ros_plans import goal, ignore, seconds, states
from sensor_msgs.msg import JointState

from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.ros.client import Feedback, MotionClient
from motiondiffuse_ros.ros.processes import ros_arguments, running
from motiondiffuse_ros.ros.qos import STREAM

ROBOT = get_robot("humanoid")
JOINTS = "/robot/joint_states"

pytestmark = pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)


@pytest.fixture
def client(graph) -> Iterator[MotionClient]:
    """A client of a node of its own, which lets goals take over."""
    arguments = ros_arguments(**FAST, preempt=True, joint_states=JOINTS)
    with (
        running("motiondiffuse_ros.ros.node", arguments, graph / "node.log") as process,
        MotionClient(lambda: process.poll() is None) as client,
    ):
        client.wait_for_node(START)
        yield client


def test_a_goal_during_execution_goes_on_from_there(client):
    points: list[JointState] = []
    client.node.create_subscription(JointState, "/motiondiffuse/reference", points.append, STREAM)
    plans = [
        client.generate(goal("a person walks forward", 30.0, seed=1), ignore, ANSWER).plan,
        client.generate(goal("a person waves", 3.0, seed=2), ignore, ANSWER).plan,
    ]
    (old, began), (new, taken_over) = map(states, plans)
    assert 0.0 < taken_over - began < old.trajectory.duration

    here, first = old.at(taken_over - began), new.at(0.0)
    assert np.abs(np.degrees(first.positions - here.positions)).max() < 1.0
    assert np.abs(first.velocities - here.velocities).max() < 0.5
    assert here.root is not None
    assert first.root is not None
    np.testing.assert_allclose(first.root.position, here.root.position, atol=0.01)

    end = new.trajectory.positions[-1]
    client.wait(
        lambda: bool(points) and np.allclose(points[-1].position, end, atol=1e-12),
        ANSWER,
        "the last set-point",
    )
    # the stream is that of the old plan up to the seam, and of the new one from there
    times = np.array([seconds(p.header.stamp) for p in points])
    assert times[0] < taken_over < times[-1]
    for time, point in zip(times, points, strict=True):
        asked = new.at(time - taken_over) if time >= taken_over else old.at(time - began)
        assert np.abs(np.degrees(asked.positions - point.position)).max() < 1.0
        assert np.abs(asked.velocities - point.velocity).max() < 0.5


def test_a_newer_goal_ends_the_planning_in_work(client):
    feedback: list[Feedback] = []
    handle = client.send(goal("a person walks", 2.0, steps=1000), feedback.append, ANSWER)
    client.wait(lambda: bool(feedback), ANSWER, "feedback")
    newer = client.generate(goal("a person bows", 1.0), ignore, ANSWER)
    assert newer.error_code == ErrorCode.SUCCESS
    result = client.result(handle, ANSWER)
    assert result.error_code == ErrorCode.SUPERSEDED
    assert "while it was worked on" in result.message


def test_a_plan_starts_where_the_robot_says_it_is(client):
    joints = client.node.create_publisher(JointState, JOINTS, STREAM)
    present = JointState(name=list(reversed(ROBOT.joint_names)))
    present.position = list(reversed(ROBOT.rest_positions.tolist()))
    timer = client.node.create_timer(0.05, lambda: joints.publish(present))
    client.wait(lambda: joints.get_subscription_count() > 0, ANSWER, "a reader of the joints")
    plan = client.generate(goal("a person raises both arms", 2.0), ignore, ANSWER).plan
    client.node.destroy_timer(timer)
    start, _ = states(plan)
    np.testing.assert_allclose(start.at(0.0).positions, ROBOT.rest_positions, atol=1e-9)
    assert not start.at(0.0).velocities.any()
