"""The same trajectory to the last bit, or the reason why not."""

from dataclasses import replace

import numpy as np
import pytest

from motiondiffuse_ros.continuation import Start
from motiondiffuse_ros.diffusion.threads import Threads, sharing, threads
from motiondiffuse_ros.edit import Edit
from motiondiffuse_ros.errors import RecordingError
from motiondiffuse_ros.joined_plan import join_plans
from motiondiffuse_ros.manifest import shipped
from motiondiffuse_ros.pieces import split
from motiondiffuse_ros.recording import (
    Record,
    difference,
    doubts,
    planner_of,
    read_recording,
    record_of,
    replay,
    write_recording,
)
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState


@pytest.fixture
def again(planner, tmp_path):
    """Record a plan, and plan what the file says with a planner of its own."""

    def replayed(plan):
        write_recording(tmp_path / "plan.mcap", record_of(planner, plan))
        record = read_recording(tmp_path / "plan.mcap")
        new = replay(record, planner_of(record))
        return record, new

    return replayed


def test_a_plan_is_the_same_again(again, plan):
    record, new = again(plan)
    assert difference(record, new.trajectory) == ""
    assert new.trajectory.accelerations is not None
    assert new.candidate == plan.candidate
    assert doubts(record) == []


def test_a_plan_that_continues_another_and_came_late_is_the_same_again(again, planner, plan):
    running, robot = TrajectoryState(plan.trajectory), get_robot("humanoid")
    lead_in = running.motion_up_to(robot, 0.7, 1.0, planner.fps)
    request = MotionRequest.from_text("a person waves", 2.0, seed=1, candidates=1)
    new = planner.plan(request, start=Start(lead_in, running.at(0.7)))
    for late in (0.9, 1.1):
        new = planner.restarted(new, running.at(late))
    record, once_more = again(new)
    assert record.restarts == 2
    assert difference(record, once_more.trajectory) == ""
    # and it does depend on what it continues
    apart = planner.plan(request)
    assert difference(record, apart.trajectory) != ""


def test_a_plan_that_was_joined_from_pieces_is_the_same_again(again, planner):
    request = MotionRequest.from_text("a person walks forward", 6.0, seed=3, candidates=1)
    robot, plans, seams = get_robot("humanoid"), [], (2.0, 2.1)
    for i, piece in enumerate(split(request, 2.0)):
        start = None
        if plans:
            running, seam = TrajectoryState(plans[-1].trajectory), seams[i - 1]
            start = Start(running.motion_up_to(robot, seam, 1.0, planner.fps), running.at(seam))
        plans.append(planner.plan(piece.request, start=start))
    plans[1] = planner.restarted(plans[1], TrajectoryState(plans[0].trajectory).at(2.05))
    record, new = again(join_plans(request, plans, (2.05, seams[1])))
    assert [piece.restarts for piece in record.pieces] == [0, 1, 0]
    assert difference(record, new.trajectory) == ""
    assert new.report.verdict == record.plan["report"]["verdict"]


def test_an_edit_is_the_same_again_without_its_file(again, planner, plan, tmp_path):
    file = tmp_path / "motion.npz"
    plan.motion.save_npz(file)
    request = MotionRequest.from_text("a person raises the left arm", 2.0, seed=1, candidates=1)
    new = planner.plan(replace(request, edit=Edit(str(file), ("left_arm",))))
    record = record_of(planner, new)
    file.unlink()
    assert difference(record, replay(record, planner).trajectory) == ""


@pytest.mark.parametrize("then", [Threads(2), Threads(1, halves=True)])
def test_as_many_threads_are_used_as_then(planner, then):
    request = MotionRequest.from_text("a person walks", 1.0, seed=3, candidates=1, steps=2)
    with sharing(then):
        record = record_of(planner, planner.plan(request))
    with sharing(Threads(1)):
        new = replay(record, planner)
        assert threads() == Threads(1)
    assert Record.from_dict(record.to_dict(), record.values, b"").threads == then
    assert difference(record, new.trajectory) == ""


def test_another_robots_plan_is_the_same_again(again, planner, g1):
    request = MotionRequest.from_text("a person bows", 2.0, seed=1, candidates=1, robot="g1")
    record, new = again(planner.plan(request))
    assert difference(record, new.trajectory) == ""
    assert {"robot/description", "robot/model"} <= set(record.hashes)
    assert not any(name.startswith("critic/") for name in record.hashes)  # nothing to choose from


@pytest.mark.parametrize(
    "name",
    [
        *("weights/model.safetensors", "critic/text_motion.safetensors", "text encoder/minilm"),
        "robot/model",
    ],
)
def test_other_files_than_the_recorded_ones_are_refused(record, name):
    altered = replace(record, hashes={**record.hashes, name: 64 * "0"})
    with pytest.raises(RecordingError, match=f"{name} is not the one that was recorded"):
        planner_of(altered)


def test_other_weights_are_refused(record):
    with pytest.raises(RecordingError, match="weights/"):
        planner_of(record, shipped("cmu"))


def test_another_library_is_a_doubt(record):
    altered = replace(record, surroundings={**record.surroundings, "torch": "1.0"})
    (doubt,) = doubts(altered)
    assert "torch: recorded with 1.0, here " in doubt


def test_a_difference_is_told_with_place_and_size(record, plan):
    positions = plan.trajectory.positions.copy()
    positions[50, 3] += 0.25
    altered = replace(plan.trajectory, positions=positions)
    found = difference(record, altered)
    assert found == f"positions at 1 of {len(positions)} points from 1.00 s on, by up to 0.25"
    signed = replace(plan.trajectory, velocities=np.negative(plan.trajectory.velocities))
    assert "velocities at " in difference(record, signed)
