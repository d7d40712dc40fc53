"""Messages and dataclasses carry the same."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header
from synthetic import waving

from motiondiffuse_ros.edit import Edit
from motiondiffuse_ros.errors import InputError, RequestError
from motiondiffuse_ros.motion import PARTS
from motiondiffuse_ros.msg import MotionEdit, PlausibilityReport
from motiondiffuse_ros.msg import MotionRequest as MotionRequestMsg
from motiondiffuse_ros.physics.report import METRICS, Report
from motiondiffuse_ros.request import MotionRequest, Segment
from motiondiffuse_ros.robots import build_trajectory, get_robot
from motiondiffuse_ros.ros.conversions import (
    joint_trajectory_to_message,
    report_to_message,
    request_from_message,
    request_to_message,
    root_trajectory_to_message,
    trajectory_from_messages,
)
from motiondiffuse_ros.waypoint import Waypoint

numbers = st.floats(allow_nan=False, allow_infinity=False)
segments = st.builds(
    Segment,
    text=st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=40),
    start=numbers,
    end=numbers,
    parts=st.lists(st.sampled_from(tuple(PARTS)), max_size=3).map(tuple),
)
waypoints = st.builds(Waypoint, time=numbers, x=numbers, y=numbers, heading=st.none() | numbers)
edits = st.builds(
    Edit,
    motion=st.text("abc/.", min_size=1, max_size=20),
    regenerate=st.lists(st.sampled_from(tuple(PARTS)), max_size=3).map(tuple),
    keep=st.lists(st.tuples(numbers, numbers), max_size=3).map(tuple),
)
requests = st.builds(
    MotionRequest,
    segments=st.lists(segments, max_size=4).map(tuple),
    duration=st.none() | st.floats(0.5, 100.0),
    seed=st.none() | st.integers(0, 2**63 - 1),
    guidance_scale=st.none() | st.floats(0.1, 20.0),
    steps=st.none() | st.integers(1, 1000),
    candidates=st.none() | st.integers(1, 64),
    robot=st.sampled_from(["humanoid", "g1"]),
    waypoints=st.lists(waypoints, max_size=3).map(tuple),
    edit=st.none() | edits,
)


@settings(deadline=None)
@given(requests)
def test_a_request_survives_the_wire(request):
    wire = serialize_message(request_to_message(request))
    assert request_from_message(deserialize_message(wire, MotionRequestMsg), robot="x") == request


def test_an_empty_message_leaves_everything_to_the_node():
    request = request_from_message(MotionRequestMsg(), robot="humanoid")
    assert request == MotionRequest(segments=(), robot="humanoid")


def test_a_negative_seed_is_refused():
    with pytest.raises(RequestError, match="seed is -2"):
        request_from_message(MotionRequestMsg(seed=-2), robot="humanoid")


def test_spans_without_an_end_are_refused():
    edit = MotionEdit(file="a.npz", keep_start=[0.0, 2.0], keep_end=[1.0])
    with pytest.raises(RequestError, match="2 starts of spans to keep and 1 ends"):
        request_from_message(MotionRequestMsg(edit=edit), robot="humanoid")


def test_a_trajectory_survives_the_wire():
    trajectory = build_trajectory(get_robot("humanoid"), waving(40))
    back = trajectory_from_messages(
        joint_trajectory_to_message(trajectory, Header()),
        root_trajectory_to_message(trajectory, Header()),
    )
    assert back.joint_names == trajectory.joint_names
    assert np.allclose(back.times, trajectory.times, atol=1e-9)
    for name in (
        *("positions", "velocities", "root_position", "root_orientation"),
        *("root_linear_velocity", "root_angular_velocity"),
    ):
        assert np.array_equal(getattr(back, name), getattr(trajectory, name)), name


def test_accelerations_go_along_where_they_were_asked_for():
    robot = get_robot("humanoid")
    plain = build_trajectory(robot, waving(20))
    assert not joint_trajectory_to_message(plain, Header()).points[3].accelerations
    full = build_trajectory(robot, waving(20), accelerations=True)
    assert full.accelerations is not None
    point = joint_trajectory_to_message(full, Header()).points[3]
    assert np.array_equal(point.accelerations, full.accelerations[3])
    change = (full.velocities[4] - full.velocities[2]) * 25.0
    assert np.allclose(point.accelerations, change)


def messages() -> tuple[Any, Any]:
    trajectory = build_trajectory(get_robot("humanoid"), waving(40))
    return (
        joint_trajectory_to_message(trajectory, Header()),
        root_trajectory_to_message(trajectory, Header()),
    )


def broken(kind) -> tuple[Any, Any]:
    joints, root = messages()
    if kind == "no points":
        joints.points = []
    elif kind == "missing velocity":
        joints.points[3].velocities.pop()
    elif kind == "not a number":
        joints.points[3].positions[0] = math.nan
    elif kind == "times stand still":
        joints.points[3].time_from_start = joints.points[2].time_from_start
    elif kind == "root of another length":
        root.points = root.points[:-1]
    else:
        root.points[0].transforms = []
    return joints, root


@pytest.mark.parametrize(
    "kind",
    [
        *("no points", "missing velocity", "not a number", "times stand still"),
        *("root of another length", "no root pose"),
    ],
)
def test_a_broken_trajectory_is_refused(kind):
    with pytest.raises(InputError):
        trajectory_from_messages(*broken(kind))


def test_the_message_has_every_metric_of_the_report():
    fields = PlausibilityReport.get_fields_and_field_types()
    assert set(METRICS) <= set(fields)
    assert all(fields[name] == "double" for name in METRICS)


def test_a_report_keeps_its_numbers_and_says_what_was_not_computed():
    report = Report(
        verdict="marginal",
        reasons=("left foot slides",),
        score=0.5,
        metrics={"skate_mm": 3.0, "float_mm": None},
        segments=(),
    )
    message = report_to_message(report)
    assert message.verdict == PlausibilityReport.MARGINAL
    assert message.reasons == ["left foot slides"]
    assert message.score == 0.5
    assert message.skate_mm == 3.0
    assert math.isnan(message.float_mm)
    assert math.isnan(message.tracking_mpjpe_mm)
