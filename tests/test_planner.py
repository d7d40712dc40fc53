"""The use case with the shipped weights, at few steps."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

from motiondiffuse_ros.continuation import Start
from motiondiffuse_ros.edit import Edit
from motiondiffuse_ros.errors import Cancelled, MotionFileError, RequestError, RobotError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.parts import part_joints
from motiondiffuse_ros.planner import Planner, PlannerConfig, timeline
from motiondiffuse_ros.request import MotionRequest, Segment
from motiondiffuse_ros.robots import broken_promises, get_robot
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState
from motiondiffuse_ros.waypoint import Waypoint


@pytest.fixture(scope="module")
def planner():
    return Planner(PlannerConfig(steps=8, candidates=2, track=False))


@pytest.fixture(scope="module")
def plan(planner):
    seen = []
    request = MotionRequest.from_text("a person walks forward", 3.0, seed=3)
    result = planner.plan(request, progress=seen.append)
    return result, seen


def test_the_trajectory_keeps_its_promises(plan):
    result, _ = plan
    assert broken_promises(result.trajectory, get_robot("humanoid")) == ()
    assert len(result.trajectory.joint_names) == 63


def test_progress_rises_through_the_stages(plan):
    _, seen = plan
    fractions = [p.fraction for p in seen]
    assert fractions == sorted(fractions)
    assert [s for i, s in enumerate(p.stage for p in seen) if i == 0 or s != seen[i - 1].stage] == [
        "text",
        "sampling",
        "physics",
        "retargeting",
    ]
    assert fractions[-1] == pytest.approx(1.0)


def test_the_same_seed_gives_the_same_motion(planner, plan):
    result, _ = plan
    again = planner.plan(result.request)
    np.testing.assert_array_equal(again.motion.rotations, result.motion.rotations)
    np.testing.assert_array_equal(again.trajectory.positions, result.trajectory.positions)


def test_candidates_are_matched_with_the_text_only_to_choose_among_them(planner, plan):
    chosen, _ = plan
    assert chosen.text_match is not None
    assert -2.0 <= chosen.text_match <= 2.0
    alone = planner.plan(replace(chosen.request, candidates=1))
    assert alone.to_dict()["text_match"] is None


def test_a_drawn_seed_is_recorded_and_reproduces(planner):
    first = planner.plan(MotionRequest.from_text("a person bows", 2.0))
    again = planner.plan(MotionRequest.from_text("a person bows", 2.0, seed=first.seed))
    np.testing.assert_array_equal(again.motion.root, first.motion.root)


def test_who_is_in_a_hurry_takes_few_steps_where_whole_body_texts_are_all(planner):
    plain = MotionRequest.from_text("a person walks forward", 2.0, seed=1, candidates=1)
    few = planner.hurried(plain).steps
    assert few < planner.config.steps
    assert planner.hurried(replace(plain, steps=2)).steps == 2
    for other in (
        replace(plain, guidance_scale=2.0),
        replace(plain, waypoints=(Waypoint(2.0, 1.0, 0.0),)),
        replace(plain, segments=(*plain.segments, Segment("waves", 0.0, 2.0, ("right_arm",)))),
    ):
        assert planner.hurried(other) == other

    plan = planner.plan(planner.hurried(plain))
    assert plan.request.steps == few
    assert plan.few_steps_sha256 == planner.hashes["weights/few_steps.safetensors"]
    assert plan.weights_sha256 == planner.hashes["weights/model.safetensors"]
    assert planner.plan(plain).few_steps_sha256 == ""


def test_files_follow_the_contract(plan, tmp_path):
    result, _ = plan
    result.save(tmp_path)
    saved = json.loads((tmp_path / "plan.json").read_text())
    assert saved["seed"] == 3
    assert len(saved["weights_sha256"]) == 64
    assert set(saved["timings_s"]) == {"text", "sampling", "physics", "retargeting", "total"}
    assert json.loads((tmp_path / "report.json").read_text()) == saved["report"]
    assert MotionRequest.from_dict(saved["request"]) == result.request
    motion = Motion.load_npz(tmp_path / "motion.npz")
    np.testing.assert_allclose(motion.root[0, :2], 0.0, atol=1e-6)
    assert abs(motion.heading[0]) < 1e-3
    with (tmp_path / "trajectory.csv").open() as file:
        rows = list(csv.reader(file))
    names = result.trajectory.joint_names
    assert rows[0] == ["time", *(f"{n}_{k}" for n in names for k in ("position", "velocity"))]
    assert len(rows) == 1 + len(result.trajectory.times)


def test_segments_and_parts_become_one_plan_with_a_report_each(planner):
    request = MotionRequest(
        (
            Segment("a person walks forward", 0.0, 2.0),
            Segment("a person stands still", 2.0, 4.0),
            Segment("a person waves with the right hand", 1.0, 3.0, ("right_arm",)),
        ),
        seed=0,
    )
    result = planner.plan(request)
    assert result.motion.duration == pytest.approx(4.0)
    assert [s.text for s in result.report.segments] == [s.text for s in request.segments]


def test_long_motions_go_beyond_the_window(planner):
    request = MotionRequest.from_text("a person walks forward", 25.0, seed=0, candidates=1, steps=3)
    assert planner.plan(request).motion.duration == pytest.approx(25.0)


def test_cancel_stops_the_sampler(planner):
    seen = []
    with pytest.raises(Cancelled):
        planner.plan(
            MotionRequest.from_text("a person walks", 3.0, seed=0),
            progress=seen.append,
            cancelled=lambda: any(p.stage == "sampling" for p in seen),
        )
    assert seen[-1].stage == "sampling"


def test_bad_requests_are_refused_before_any_work(planner):
    seen = []
    with pytest.raises(RequestError, match="empty"):
        planner.plan(MotionRequest.from_text(" "), progress=seen.append)
    with pytest.raises(RobotError, match="humanoid"):
        planner.plan(MotionRequest.from_text("walk", robot="toaster"), progress=seen.append)
    assert seen == []


def test_times_become_frames_with_both_ends():
    request = MotionRequest((Segment("a", 0.0, 1.0), Segment("b", 1.0, 2.0)))
    texts, frames = timeline(request, 20.0)
    assert frames == 41
    assert [(t.start, t.stop) for t in texts] == [(0, 20), (20, 41)]


def test_a_circle_without_a_side_is_told_and_judged_with_one():
    typed = "[0-4] walk in a circle | [4-6] a person stands"
    request = MotionRequest.from_text(typed)
    texts, _ = timeline(request, 20.0)
    assert [t.text for t in texts] == ["walk in a circle to the left", "a person stands"]
    assert request.segments[0].text == "walk in a circle"


def test_the_root_passes_waypoints_in_motion_and_trajectory(planner):
    waypoints = (Waypoint(2.0, 1.5, 0.5), Waypoint(4.0, 2.0, 2.0, np.pi / 2))
    plan = planner.plan(
        MotionRequest.from_text("a person walks", 4.0, seed=1, candidates=1, waypoints=waypoints)
    )
    motion, trajectory = plan.motion, plan.trajectory
    for waypoint in waypoints:
        frame, point = round(waypoint.time * motion.fps), round(waypoint.time * 50)
        place = [waypoint.x, waypoint.y]
        np.testing.assert_allclose(motion.root[frame, :2], place, atol=0.15)
        np.testing.assert_allclose(trajectory.root_position[point, :2], place, atol=0.15)
    assert motion.heading[-1] == pytest.approx(np.pi / 2, abs=np.radians(15.0))
    np.testing.assert_allclose(motion.root[0, :2], 0.0, atol=1e-6)


@pytest.mark.parametrize(("seam", "late", "text"), [(1.1, 0.0, "runs"), (2.3, 0.4, "bows")])
def test_a_motion_goes_on_where_another_was_left(planner, plan, seam, late, text):
    old, _ = plan
    robot = get_robot("humanoid")
    running = TrajectoryState(old.trajectory)
    lead_in = running.motion_up_to(robot, seam, 1.0, planner.fps)
    new = planner.plan(
        MotionRequest.from_text(f"a person {text}", 3.0, seed=1, candidates=1),
        start=Start(lead_in, running.at(seam)),
    )
    assert new.motion.duration == pytest.approx(3.0)
    np.testing.assert_allclose(new.motion.positions[0], lead_in.positions[-1], atol=1e-3)
    # it does not snap away from there: a twentieth of a second later every joint is near, as far as
    # the foot that is swung allows
    before = np.linalg.norm(lead_in.positions[-1] - lead_in.positions[-2], axis=1)
    step = np.linalg.norm(new.motion.positions[1] - lead_in.positions[-1], axis=1)
    assert step.max() < max(0.2, 1.5 * before.max())

    here = running.at(seam + late)
    assert here.root is not None
    if late:
        new = planner.restarted(new, here)
    np.testing.assert_allclose(new.motion.root[0, :2], here.root.position[:2], atol=1e-2)
    np.testing.assert_array_equal(new.trajectory.positions[0], here.positions)
    np.testing.assert_array_equal(new.trajectory.velocities[0], here.velocities)
    np.testing.assert_allclose(new.trajectory.root_position[0], here.root.position, atol=1e-9)
    assert broken_promises(new.trajectory, robot) == ()


def test_waypoints_of_a_continued_motion_count_from_its_start(planner, plan):
    old, _ = plan
    waypoint = Waypoint(2.5, 1.0, 1.0, 0.8)
    new = planner.plan(
        MotionRequest.from_text("a person walks", 3.0, seed=1, candidates=1, waypoints=(waypoint,)),
        start=Start(old.motion.slice(0, 41)),
    ).motion.canonicalised()
    np.testing.assert_allclose(new.root[50, :2], [1.0, 1.0], atol=0.15)
    assert new.heading[50] == pytest.approx(0.8, abs=np.radians(15.0))


@pytest.fixture
def saved(plan, tmp_path):
    motion = plan[0].motion
    motion.save_npz(tmp_path / "motion.npz")
    return motion, str(tmp_path / "motion.npz")


def edited(planner, edit, seconds=3.0):
    text = "a person raises the left arm"
    request = MotionRequest.from_text(text, seconds, seed=2, candidates=1, edit=edit)
    return planner.plan(request).motion


def turned_by(one, other):
    """Return by how much each joint is turned at most [J], degrees."""
    return np.degrees(rot.angle_between(one.rotations, other.rotations)).max(axis=0)


def test_parts_that_are_kept_stay_and_the_others_are_made_anew(planner, saved):
    motion, file = saved
    turned = turned_by(edited(planner, Edit(file, ("left_arm",))), motion)
    arm = list(part_joints("left_arm"))
    assert np.delete(turned, arm).max() < 1.0
    assert turned[arm].max() > 10.0


def test_frames_that_are_kept_are_in_their_places_and_what_is_between_is_made_anew(planner, saved):
    motion, file = saved
    new = edited(planner, Edit(file, keep=((0.0, 0.5), (2.5, 3.0))))
    moved = np.linalg.norm(new.positions - motion.positions, axis=2).max(axis=1)
    assert moved[:11].max() < 0.02
    assert moved[50:].max() < 0.02
    assert moved[15:45].max() > 0.1
    # no joint is thrown from the kept frames to the new ones
    assert np.linalg.norm(np.diff(new.positions, axis=0), axis=2).max() < 0.4


def test_an_edit_of_a_bvh_file_keeps_what_it_should(planner, plan, tmp_path):
    plan[0].save(tmp_path)
    file = str(tmp_path / "motion.bvh")
    turned = turned_by(edited(planner, Edit(file, ("head",))), plan[0].motion)
    assert np.delete(turned, list(part_joints("head"))).max() < 1.0


def test_edits_that_do_not_fit_are_refused_before_any_work(planner, saved):
    _, file = saved
    with pytest.raises(RequestError, match=r"lasts 3\.00 s, the request's motion 5\.00 s"):
        edited(planner, Edit(file, ("head",)), 5.0)
    with pytest.raises(MotionFileError, match="no such file"):
        edited(planner, Edit("none.npz", ("head",)))


def test_a_plan_for_another_robot_is_that_robots(planner, g1, tmp_path):
    request = MotionRequest.from_text("a person walks forward", 2.0, seed=3, robot="g1")
    plan = planner.plan(request)
    assert plan.trajectory.joint_names == g1.joint_names
    assert broken_promises(plan.trajectory, g1) == ()
    plan.save(tmp_path)
    rows = np.loadtxt(tmp_path / "tracking.csv", delimiter=",")
    assert rows.shape == (len(plan.trajectory.times), 7 + 29)
    assert (tmp_path / "tracking.npz").is_file()

    # taken up later, from where the robot has got to
    state = TrajectoryState(plan.trajectory).at(1.0)
    assert state.root is not None
    again = planner.restarted(plan, state)
    assert broken_promises(again.trajectory, g1) == ()
    np.testing.assert_allclose(again.trajectory.root_position[0], state.root.position, atol=1e-9)
    walked = again.trajectory.root_position[-1] - again.trajectory.root_position[0]
    # the motion sets out from there too: the base is not dragged across the floor
    assert np.linalg.norm(walked[:2]) < 1.5 * np.linalg.norm(
        (plan.trajectory.root_position[-1] - plan.trajectory.root_position[0])[:2]
    )
