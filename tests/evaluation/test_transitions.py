"""Measures of transitions and seams, on motions of which it is known how they hang together."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic import drifting, smooth_motions, standing, waving

from motiondiffuse_ros.evaluation.transitions import (
    area_under_jerk,
    around,
    jerk_curve,
    max_jerk,
    only_part,
    peak_jerk,
    seam_gap,
    seam_jerk,
    transition_distance,
)
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.parts import PARTS, part_joints

STATE = PoseState()
ARMS = ("left_arm", "right_arm")


def _hard_cut(one: Motion, other: Motion) -> Motion:
    return replace(
        one,
        root=np.concatenate([one.root, other.root]),
        rotations=np.concatenate([one.rotations, other.rotations]),
    )


def test_a_hard_cut_shows_in_every_measure():
    smooth = waving(80)
    cut = _hard_cut(standing(40), waving(40))
    usual = float(max_jerk(smooth).mean())
    windows = [around(motion, 40) for motion in (smooth, cut)]
    curves = [jerk_curve([window]) for window in windows if window is not None]
    peaks = [peak_jerk(curve) for curve in curves]
    areas = [area_under_jerk(curve, usual, 20.0) for curve in curves]
    steps = [transition_distance(motion, [40])[0] for motion in (smooth, cut)]
    for calm, torn in (peaks, areas, steps):
        assert torn > 5.0 * calm


def test_jerk_has_units():
    # x = t^3 has a jerk of 6 m/s^3, whatever the rate
    for fps in (20.0, 30.0):
        still = standing(30, fps)
        times = np.arange(30)[:, None] / fps
        moving = replace(still, root=still.root + times**3 * [1.0, 0.0, 0.0])
        np.testing.assert_allclose(max_jerk(moving), 6.0, rtol=1e-6)


@given(smooth_motions(), st.floats(-3.0, 3.0), st.floats(-5.0, 5.0))
@settings(deadline=None, max_examples=25)
def test_transition_distance_does_not_see_where_and_which_way(motion, angle, speed):
    if motion.frames < 2:
        return
    turn = rot.about_axis(2, np.array(angle))
    rotations = motion.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    elsewhere = drifting(replace(motion, rotations=rotations), speed)
    frames = [1, motion.frames - 1]
    np.testing.assert_allclose(
        transition_distance(elsewhere, frames), transition_distance(motion, frames), atol=1e-9
    )


def test_a_window_that_leaves_the_motion_is_none():
    motion = standing(40)
    window = around(motion, 20)
    assert window is not None
    assert window.frames == 20
    assert around(motion, 9) is None
    assert around(motion, 31) is None


@given(smooth_motions())
@settings(deadline=None, max_examples=25)
def test_parts_of_one_motion_have_no_gap(motion):
    assert seam_gap(STATE.encode(motion), motion.fps, PARTS) < 1e-4


def test_an_arm_put_on_another_trunk_has_a_gap():
    upright, bent = waving(40), waving(40)
    rotations = bent.rotations.copy()
    spine = bent.skeleton.index("spine2")
    rotations[:, spine] = rot.about_axis(1, np.full(40, 0.5))
    features = STATE.encode(replace(bent, rotations=rotations))
    arm = STATE.part_indices("right_arm")
    features[:, arm] = STATE.encode(upright)[:, arm]
    assert seam_gap(features, 20.0, ["right_arm"]) > 0.1
    assert seam_gap(features, 20.0, ["legs", "left_arm"]) < 1e-4


def test_seam_jerk_sees_the_arm_and_not_the_steps():
    rng = np.random.default_rng(0)
    still = waving(60)
    shaking = replace(still, root=still.root + 0.02 * rng.normal(size=still.root.shape))
    assert seam_jerk(shaking, ARMS) == pytest.approx(seam_jerk(still, ARMS), abs=1e-6)
    rotations = still.rotations.copy()
    shoulder = still.skeleton.index("right_shoulder")
    noise = rot.about_axis(0, 0.05 * rng.normal(size=60))
    rotations[:, shoulder] = rot.multiply(rotations[:, shoulder], noise)
    assert seam_jerk(replace(still, rotations=rotations), ARMS) > 2.0 * seam_jerk(still, ARMS)


@pytest.mark.parametrize("part", PARTS)
def test_only_the_part_moves(part):
    motion, stand = drifting(waving(30), 1.0), standing(1)
    seen = only_part(motion, [part], stand)
    own = list(part_joints(part))
    np.testing.assert_array_equal(seen.rotations[:, own], motion.rotations[:, own])
    others = [j for j in range(22) if j not in own]
    np.testing.assert_array_equal(
        seen.rotations[:, others], np.repeat(stand.rotations[:, others], 30, axis=0)
    )
    assert (np.ptp(seen.root, axis=0).max() > 0.5) == (part == "legs")
