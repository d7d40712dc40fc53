import numpy as np
from hypothesis import given, settings
from synthetic import smooth_motions, standing, waving

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.from_positions import motion_from_positions


@settings(deadline=None, max_examples=30)
@given(smooth_motions())
def test_the_joints_come_back_wherever_they_are(motion):
    found = motion_from_positions(motion.positions, motion.fps)
    np.testing.assert_allclose(found.positions, motion.positions, atol=1e-6)


def test_a_body_of_another_size_gives_the_same_motion():
    motion = waving(10)
    found = motion_from_positions(motion.positions * 640.0, motion.fps)
    np.testing.assert_allclose(found.positions, motion.positions, atol=1e-6)


def test_no_twist_is_added():
    # hinges and the shortest way down hold no twist, so that the rotations are found as well
    motion = standing(3)
    found = motion_from_positions(motion.positions, motion.fps)
    leaves = [CANONICAL.index(f"{s}_wrist") for s in ("left", "right")]
    angle = rot.angle_between(found.global_rotations, motion.global_rotations)
    assert np.delete(angle, leaves, axis=1).max() < 1e-5


@settings(deadline=None, max_examples=20)
@given(smooth_motions())
def test_a_reflected_body_gives_the_mirrored_motion(motion):
    reflected = motion.positions[:, list(CANONICAL.mirror_index)] * [1.0, -1.0, 1.0]
    found = motion_from_positions(reflected, motion.fps)
    mirrored = motion_from_positions(motion.positions, motion.fps).mirrored()
    np.testing.assert_allclose(found.positions, mirrored.positions, atol=1e-6)


def test_a_bone_straight_against_its_parent_is_still_turned():
    motion = standing(2)
    folded = motion.positions.copy()
    wrist, elbow, shoulder = (CANONICAL.index(f"left_{j}") for j in ("wrist", "elbow", "shoulder"))
    folded[:, wrist] = folded[:, elbow] + 0.9 * (folded[:, shoulder] - folded[:, elbow])
    found = motion_from_positions(folded, motion.fps)
    bone = found.positions[:, wrist] - found.positions[:, elbow]
    assert np.isfinite(found.rotations).all()
    np.testing.assert_allclose(
        rot.unit(bone), rot.unit(folded[:, wrist] - folded[:, elbow]), atol=1e-6
    )
