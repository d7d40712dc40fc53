"""A robot with other joints does what the skeleton does, inside its limits and on its feet."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from synthetic import standing, turned, waving

from motiondiffuse_ros.errors import Cancelled
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.robots import broken_promises, build_trajectory, path_scale, retarget
from motiondiffuse_ros.robots.embodiment import embodiment
from motiondiffuse_ros.robots.self_collision import self_collision_pairs
from motiondiffuse_ros.robots.start_state import StartState
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState


@pytest.fixture(scope="module", params=["g1", "booster_t1"])
def robot(request):
    return request.getfixturevalue(request.param)


def squatting(frames=60):
    """Stand, bend the knees with level feet, rise again; lean ahead meanwhile."""
    still = standing(frames)
    depth = 0.5 * (1.0 - np.cos(2 * np.pi * np.arange(frames) / (frames - 1)))
    rotations = still.rotations.copy()
    for side in SIDES:
        turned(rotations, f"{side}_hip", 1, -0.9 * depth)
        turned(rotations, f"{side}_knee", 1, 1.8 * depth)
        turned(rotations, f"{side}_ankle", 1, -0.9 * depth)
    turned(rotations, "spine1", 1, 0.3 * depth)
    moved = replace(still, rotations=rotations)
    ankle = moved.joint("left_ankle") - still.joint("left_ankle")
    return replace(moved, root=still.root - ankle)


def turning(frames=80):
    """Turn about the left foot as if on a plate: the right foot travels around it."""
    still = standing(frames)
    angle = np.linspace(0.0, 1.5, frames)
    rotations = still.rotations.copy()
    rotations[:, 0] = rot.about_axis(2, angle)
    around = np.array([0.0, 0.09, 0.0])
    return replace(
        still,
        root=still.root + around - rot.rotate(rot.about_axis(2, angle), around),
        rotations=rotations,
    )


def sites(robot, frames, *names):
    """Return positions [T, names, 3] of the robot's sites for canonical joints."""
    data, out = mujoco.MjData(robot.model), []
    for pose in zip(frames.root_position, frames.root_orientation, frames.joints, strict=True):
        data.qpos[:] = np.concatenate(pose)
        mujoco.mj_kinematics(robot.model, data)
        out.append([data.site(robot.description.body_map[n]).xpos.copy() for n in names])
    return np.array(out)


def test_standing_is_standing(robot):
    frames = retarget(robot, standing(10))
    feet = sites(robot, frames, "left_ankle", "right_ankle")
    assert np.allclose(feet[..., 2], embodiment(robot).ankle_height, atol=1e-3)
    assert np.allclose(feet, feet[:1], atol=1e-3)
    assert np.allclose(rot.angle_between(frames.root_orientation, rot.identity(10)), 0, atol=0.05)


def test_planted_feet_stay_planted_in_a_squat(robot):
    frames = retarget(robot, squatting())
    feet = sites(robot, frames, "left_ankle", "right_ankle")
    assert np.linalg.norm(feet - feet[0], axis=-1).max() < 2e-3
    sunk = frames.root_position[:, 2].max() - frames.root_position[:, 2].min()
    source = np.ptp(squatting().root[:, 2]) * path_scale(robot)
    assert sunk == pytest.approx(source, rel=0.15)


def test_limbs_point_where_the_skeletons_do(robot):
    motion = waving(60)
    frames = retarget(robot, motion)
    elbow, wrist = np.moveaxis(sites(robot, frames, "right_elbow", "right_wrist"), 1, 0)
    got, wanted = (
        rot.unit(wrist - elbow),
        rot.unit(motion.joint("right_wrist") - motion.joint("right_elbow")),
    )
    assert np.degrees(np.arccos(np.clip(np.sum(got * wanted, -1), -1, 1))).max() < 12


def test_it_keeps_limits_and_does_not_jump(robot):
    for motion in (squatting(), turning(), waving(60)):
        joints = retarget(robot, motion).joints
        assert (joints > robot.lower).all()
        assert (joints < robot.upper).all()
        assert np.abs(np.diff(joints, axis=0)).max() < 0.4


def test_hands_through_the_body_stay_outside(g1):
    still = standing(40)
    rotations = still.rotations.copy()
    # forearms through the belly
    for side, sign in (("left", 1.0), ("right", -1.0)):
        turned(rotations, f"{side}_elbow", 2, -sign * np.linspace(0.0, 2.2, 40))
        turned(rotations, f"{side}_shoulder", 0, -sign * 0.25)
    frames = retarget(g1, replace(still, rotations=rotations))
    data = mujoco.MjData(g1.model)
    for pose in zip(frames.root_position, frames.root_orientation, frames.joints, strict=True):
        data.qpos[:] = np.concatenate(pose)
        mujoco.mj_kinematics(g1.model, data)
        distances = [
            mujoco.mj_geomDistance(g1.model, data, *pair, 0.02, None)
            for pair in self_collision_pairs(g1)
        ]
        assert min(distances) > -0.01


def test_trajectories_keep_their_promises(robot):
    for motion in (squatting(), turning(), waving(60)):
        for rate in (20.0, 50.0):
            assert broken_promises(build_trajectory(robot, motion, rate), robot) == ()


def test_it_begins_where_the_robot_is(g1):
    start = StartState(g1.rest_positions, 0.0 * g1.rest_positions)
    trajectory = build_trajectory(g1, waving(60), start=start)
    assert broken_promises(trajectory, g1) == ()
    assert np.array_equal(trajectory.positions[0], g1.rest_positions)


def test_the_source_is_what_the_next_motion_goes_on_from(g1):
    motion = waving(60)
    trajectory = build_trajectory(g1, motion)
    lead_in = TrajectoryState(trajectory).motion_up_to(g1, 1.5, 1.0, 20.0)
    assert lead_in.frames == 21
    assert np.allclose(lead_in.rotations[-1], motion.rotations[30], atol=1e-6)
    # in the slow-down at the end the motion is passed more slowly
    at_end = TrajectoryState(trajectory).motion_up_to(g1, trajectory.duration, 0.0, 20.0)
    assert np.allclose(at_end.rotations[-1], motion.rotations[54], atol=0.02)


def test_it_tells_how_far_it_is_and_can_be_stopped(g1):
    told = []
    retarget(g1, waving(40), told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(Cancelled, match="frame 0"):
        retarget(g1, waving(40), cancelled=lambda: True)
