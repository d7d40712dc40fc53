"""Whatever a motion is in the middle of, the robot comes to rest in a stance that can be held."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from scipy.spatial import ConvexHull
from synthetic import drifting, standing, turned, waving

from motiondiffuse_ros.corpus import load_motion
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS, detect_contacts
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.physics.geometry import sole_probes
from motiondiffuse_ros.physics.repair import put_on_floor
from motiondiffuse_ros.robots import Robot, broken_promises, build_trajectory, get_robot
from motiondiffuse_ros.robots.robot import solid_points
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState

HUMANOID = get_robot("humanoid")

IN_MID_STEP = [
    *(("02_01", 43), ("02_01", 52), ("09_01", 20), ("09_01", 24), ("13_11", 54), ("141_16", 73)),
    *(("16_21", 48), ("dataset-2_run_normal_001", 38), ("dataset-2_run_normal_001", 43)),
    ("dataset-2_walk-turn-right_normal_001", 39),
]
"""Clips, and frames at 20 fps at which they are cut: in a step, in flight, leaning into a turn."""


@pytest.fixture(scope="module")
def cut(real_paths):
    """Real motions that end where nobody could stay."""
    paths = {path.stem: path for path in real_paths}
    clips = [
        (put_on_floor(load_motion(paths[name]).resample(20.0)), end) for name, end in IN_MID_STEP
    ]
    return [clip.slice(max(0, end - 60), end) for clip, end in clips]


@pytest.fixture(params=["humanoid", "g1"])
def robot(request) -> Robot:
    return HUMANOID if request.param == "humanoid" else request.getfixturevalue("g1")


def inside(robot, trajectory):
    """Return by how much the last centre of mass is inside the hull of what is on the floor, m.

    The hull of all points below 15 mm, by SciPy: not by the code that decides.
    """
    model, data = robot.model, mujoco.MjData(robot.model)
    data.qpos[:] = np.concatenate(
        [trajectory.root_position[-1], trajectory.root_orientation[-1], trajectory.positions[-1]]
    )
    mujoco.mj_forward(model, data)
    places = [
        points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        for geom in range(model.ngeom)
        if (points := solid_points(model, geom)) is not None
    ]
    on_floor = np.concatenate(places)
    on_floor = on_floor[on_floor[:, 2] < 0.015]
    if len(on_floor) < 3:
        return -np.inf
    hull = ConvexHull(on_floor[:, :2])
    base = int(model.jnt_bodyid[0])
    return -float((hull.equations @ [*data.subtree_com[base, :2], 1.0]).max())


def test_motions_cut_in_mid_step_end_in_a_stable_stance(robot, cut):
    unstable = 0
    for motion in cut:
        plain = build_trajectory(robot, motion, settle=False)
        unstable += inside(robot, plain) < 0.01
        trajectory = build_trajectory(robot, motion, accelerations=True)
        assert broken_promises(trajectory, robot) == ()
        if trajectory.duration > plain.duration + 0.1:
            assert any("comes to stand" in note for note in trajectory.notes)
        assert not any("cannot be held" in note for note in trajectory.notes)
        assert inside(robot, trajectory) > 0.03
        # up to its slow-down the motion is the same; other robots' swings differ with the landing
        same = np.flatnonzero(plain.times < motion.duration - 0.6)
        for one, other in (
            (trajectory.root_position, plain.root_position),
            *([(trajectory.positions, plain.positions)] if robot.is_canonical else []),
        ):
            np.testing.assert_allclose(one[same], other[same], atol=0.03)
        assert trajectory.accelerations is not None
        assert np.abs(trajectory.accelerations[-1]).max() < 1.0
    assert unstable > 0.7 * len(cut)


def test_accelerations_have_no_steps_where_the_ending_begins(cut):
    # the finer the points the smaller the change from one to the next
    steps = []
    for rate in (400.0, 1600.0):
        trajectory = build_trajectory(HUMANOID, cut[0], rate, accelerations=True)
        assert trajectory.accelerations is not None
        about = np.abs(trajectory.times - cut[0].duration) < 0.3
        steps.append(np.abs(np.diff(trajectory.accelerations[about], axis=0)).max())
    assert steps[1] < 0.35 * steps[0]


def test_feet_that_stand_stay_where_they_are(cut):
    for motion in cut:
        source = build_trajectory(HUMANOID, motion).source
        assert source is not None
        ending = source.motion.slice(motion.frames - 1, source.motion.frames)
        assert ending.frames > 20
        for side in SIDES:
            corners = sole_probes(side).centres(ending)
            assert corners[1:, :, 2].min() > min(corners[0, :, 2].min(), -0.01)
            if not any(
                touches
                for name, touches in zip(CONTACT_JOINTS, detect_contacts(motion)[-1], strict=True)
                if name.startswith(side)
            ):
                continue  # it steps
            speed = np.linalg.norm(np.diff(corners[..., :2], axis=0), axis=-1) * ending.fps
            assert speed.min(axis=1).max() < 0.05  # one corner is at rest: it may roll


def leaning(frames=60):
    """Bend the ankles until the body leans out over its toes."""
    still = standing(frames)
    rotations = still.rotations.copy()
    turned(rotations, "pelvis", 1, np.linspace(0.0, 0.35, frames))
    for side in SIDES:
        turned(rotations, f"{side}_ankle", 1, np.linspace(0.0, -0.35, frames))
    moved = replace(still, rotations=rotations)
    feet = [0.5 * (m.joint("left_ankle") + m.joint("right_ankle")) for m in (still, moved)]
    return replace(moved, root=still.root + feet[0] - feet[1])


def test_who_leans_out_over_the_toes_straightens_up_on_the_spot(robot):
    plain = build_trajectory(robot, leaning(), settle=False)
    trajectory = build_trajectory(robot, leaning())
    assert inside(robot, plain) < 0.0 < inside(robot, trajectory)
    assert np.abs(trajectory.root_position[-1, :2] - trajectory.root_position[0, :2]).max() < 0.06


def test_who_stands_is_left_alone(robot):
    for motion in (standing(), waving(60), drifting(waving(60), 0.5)):
        plain = build_trajectory(robot, motion, settle=False)
        trajectory = build_trajectory(robot, motion)
        np.testing.assert_array_equal(trajectory.positions, plain.positions)
        assert trajectory.notes == plain.notes


def test_who_lies_is_left_alone_and_who_falls_is_named():
    still = standing(40)
    rotations = still.rotations.copy()
    turned(rotations, "pelvis", 1, -np.pi / 2)
    lying = replace(still, rotations=rotations)
    lying = replace(lying, root=lying.root * [1.0, 1.0, 0.0] + np.array([0.0, 0.0, 0.09]))
    assert build_trajectory(HUMANOID, lying).notes == ()
    falling = replace(lying, root=lying.root + np.array([0.0, 0.0, 0.6]))
    (note,) = build_trajectory(HUMANOID, falling).notes
    assert note == "ends in a pose that cannot be held: nothing touches the floor"


def test_an_ending_can_be_left_at_any_time(robot, cut):
    for motion in cut[::4]:
        running = TrajectoryState(build_trajectory(robot, motion))
        for into in (0.1, 0.5, 1.0):
            state = running.at(motion.duration + into)
            trajectory = build_trajectory(robot, waving(60), start=state)
            assert broken_promises(trajectory, robot) == ()
            np.testing.assert_array_equal(trajectory.positions[0], state.positions)
            np.testing.assert_array_equal(trajectory.velocities[0], state.velocities)
            # and the next motion is shown what the body did, ending included
            lead_in = running.motion_up_to(robot, motion.duration + into, 1.0, 20.0)
            assert lead_in.frames == 21
            source = running.trajectory.source
            assert source is not None
            done = source.motion.joint("left_ankle")[motion.frames - 1 + round(20 * into)]
            np.testing.assert_allclose(lead_in.joint("left_ankle")[-1], done, atol=0.08)
