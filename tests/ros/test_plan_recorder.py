"""Recordings as other tools read them."""

import json
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from std_msgs.msg import Header

from motiondiffuse_ros.planner import Planner, PlannerConfig, shipped_weights
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.ros.conversions import plan_to_message
from motiondiffuse_ros.ros.plan_recorder import record_plan


@pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)
def test_messages_are_read_by_their_own_schemas(tmp_path: Path):
    planner = Planner(PlannerConfig(steps=2, candidates=1, track=False, repair=False))
    plan = planner.plan(MotionRequest.from_text("a person bows", 1.0, seed=1))
    header = Header(frame_id="map")
    header.stamp.sec, header.stamp.nanosec = 12, 34
    message = plan_to_message(plan, header, "an id")
    record_plan(tmp_path / "plan.mcap", planner, plan, message)

    with (tmp_path / "plan.mcap").open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()], validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        found = {
            channel.topic: (schema.name, item.log_time, decoded)
            for schema, channel, item, decoded in reader.iter_decoded_messages()
            if schema is not None
        }
        attached = {item.name: item.data for item in reader.iter_attachments()}
    assert {topic: kind for topic, (kind, _, _) in found.items()} == {
        "/motiondiffuse/plan": "motiondiffuse_ros/msg/MotionPlan",
        "/motiondiffuse/joint_trajectory": "trajectory_msgs/msg/JointTrajectory",
        "/motiondiffuse/root_trajectory": "trajectory_msgs/msg/MultiDOFJointTrajectory",
    }
    assert {time for _, time, _ in found.values()} == {12 * 10**9 + 34}

    read = found["/motiondiffuse/plan"][2]
    assert (read.plan_id, read.seed, read.header.frame_id) == ("an id", 1, "map")
    assert read.request.segments[0].text == "a person bows"
    joints = found["/motiondiffuse/joint_trajectory"][2]
    np.testing.assert_array_equal(
        [point.positions for point in joints.points], plan.trajectory.positions
    )
    assert joints.points[1].time_from_start.nanosec == 20_000_000
    root = found["/motiondiffuse/root_trajectory"][2]
    assert root.points[-1].transforms[0].translation.z == plan.trajectory.root_position[-1, 2]
    assert json.loads(attached["record.json"])["plan"]["report"]["verdict"] == plan.report.verdict
