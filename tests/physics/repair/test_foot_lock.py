"""Repair holds standing feet, keeps what is shown, and never makes a motion worse."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import savgol_filter
from synthetic import drifting, moved, smooth_motions, standing, turned, waving

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.physics.foot_skating import foot_skating
from motiondiffuse_ros.physics.ground_contact import ground_errors
from motiondiffuse_ros.physics.repair import repair
from motiondiffuse_ros.physics.repair.foot_lock import lock_feet
from motiondiffuse_ros.physics.repair.repair import repaired_motion, smooth_root, worse
from motiondiffuse_ros.physics.repair.two_bones import reach_ankle

UP = np.array([0.0, 0.0, 1.0])


def stepping(frames: int = 80) -> Motion:
    """March on the spot, hips and knees bending in turns."""
    still = standing(frames)
    rotations = still.rotations.copy()
    phase = np.sin(2.0 * np.pi * np.arange(frames) / 20.0)
    for side, lift in (("left", np.maximum(phase, 0.0)), ("right", np.maximum(-phase, 0.0))):
        turned(rotations, f"{side}_hip", 1, -0.8 * lift)
        turned(rotations, f"{side}_knee", 1, 1.2 * lift)
    return replace(still, rotations=rotations)


def test_feet_that_slide_are_held():
    sliding = drifting(stepping(), 0.15)
    locked = lock_feet(sliding)
    assert ground_errors(sliding).skate.mean() > 5.0
    assert ground_errors(locked).phys_err.mean() < 0.5
    assert np.nanmedian(foot_skating(locked).support_slide) < 0.01
    # still marching, as far forward as before
    assert np.abs(locked.positions - sliding.positions).max() < 0.2


def test_feet_that_graze_the_floor_clear_it():
    # straight legs that swing while the body glides: one foot stands, the other one drags
    shuffle = standing(80)
    swing = 0.25 * np.sin(2.0 * np.pi * np.arange(80) / 20.0)
    turned(shuffle.rotations, "left_hip", 1, -swing)
    turned(shuffle.rotations, "right_hip", 1, swing)
    for side, angle in (("left", swing), ("right", -swing)):
        turned(shuffle.rotations, f"{side}_ankle", 1, angle)
    dragging = drifting(shuffle, 0.6)
    repaired = repaired_motion(dragging)
    assert ground_errors(dragging).skate.mean() > 10.0
    assert ground_errors(repaired).skate.mean() < 0.1
    assert ground_errors(repaired).float_.mean() < 0.5


def test_penetration_and_float_go():
    wobble = np.zeros((80, 3))
    wobble[:, 2] = 0.015 * np.sin(np.arange(80) / 5.0)
    repaired = repaired_motion(moved(stepping(), wobble))
    errors = ground_errors(repaired)
    assert errors.penetrate.mean() < 0.5
    assert errors.float_.mean() < 0.5


def test_bones_and_what_the_arms_do_stay():
    sliding = drifting(waving(60), 0.1)
    repaired = lock_feet(sliding)
    assert np.allclose(repaired.rotations[:, 13:], sliding.rotations[:, 13:], atol=1e-9)


def test_a_flight_stays_a_flight():
    times = np.arange(60) / 20.0
    hop = np.zeros((60, 3))
    hop[20:30, 2] = np.maximum(4.905 * (times[20:30] - 1.0) * (1.5 - times[20:30]), 0.0)
    repaired = repaired_motion(moved(standing(60), hop))
    height = repaired.root[:, 2] - repaired.root[0, 2]
    assert height.max() > 0.85 * hop[:, 2].max()


@pytest.mark.parametrize("motion", [waving(60), standing(40), stepping()])
def test_a_plausible_motion_gets_no_worse(motion):
    result = repair(motion)
    assert not worse(result.after, result.before)
    assert np.abs(result.motion.positions - motion.positions).max() < 0.1


@settings(max_examples=15, deadline=None)
@given(smooth_motions())
def test_repair_takes_any_motion_and_makes_none_worse(motion):
    result = repair(motion)
    assert result.motion.frames == motion.frames
    assert np.isfinite(result.motion.positions).all()
    assert not worse(result.after, result.before)


def test_what_cannot_be_judged_is_returned_as_it_is():
    broken = waving(20)
    broken.root[3, 0] = np.nan
    assert repair(broken).motion is broken
    assert repair(standing(1)).motion.frames == 1


def test_smoothing_keeps_speed_and_acceleration_of_the_root():
    times = np.arange(40)[:, None] / 20.0
    thrown = moved(standing(40), times * [1.0, 0.5, 4.0] - 4.905 * times**2 * UP)
    assert np.allclose(smooth_root(thrown).root, thrown.root, atol=1e-9)


@pytest.mark.parametrize("fps", [20.0, 60.0])
def test_smoothing_of_the_root_is_that_of_savitzky_and_golay(fps):
    shaky = np.random.default_rng(0).normal(scale=0.01, size=(50, 3))
    still = standing(50)
    smooth = smooth_root(Motion(still.root + shaky, still.rotations, fps)).root
    frames = 7 if fps == 20.0 else 21
    assert np.allclose(smooth, savgol_filter(still.root + shaky, frames, 3, axis=0), atol=1e-9)


@given(st.floats(0.3, 0.79), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0.3, 1.5))
def test_the_ankle_gets_where_it_is_sent(far, x, y, bend):
    hip = np.zeros((1, 3))
    shank_turn = rot.about_axis(1, np.array([bend]))
    knee = np.array([[0.0, 0.0, -0.4]])
    ankle = knee + rot.rotate(shank_turn, np.array([0.0, 0.0, -0.4]))
    target = far * rot.unit(np.array([[x, y, -1.0]]))
    thigh, shank = reach_ankle(
        hip, knee, ankle, target, rot.identity(1), shank_turn, np.array([[0.0, 1.0, 0.0]])
    )
    down = np.array([0.0, 0.0, -0.4])
    reached = rot.rotate(thigh, down) + rot.rotate(shank, down)
    assert np.allclose(reached, target, atol=1e-6)
    # the knee still bends forward
    bent = np.cross(rot.rotate(thigh, down), rot.rotate(shank, down))
    assert np.dot(bent[0], rot.rotate(thigh, np.array([0.0, 1.0, 0.0]))[0]) > -1e-9
