import numpy as np
import pytest
from hypothesis import given
from synthetic import smooth_motions, waving

from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion import CANONICAL, PARTS, Motion
from motiondiffuse_ros.motion import rotations as rot


def test_t_pose_stands_at_its_offsets():
    motion = Motion(np.zeros((1, 3)), rot.identity(1, 22), 20.0)
    left, right = motion.joint("left_wrist")[0], motion.joint("right_wrist")[0]
    assert left[1] > 0.6  # y is left
    np.testing.assert_allclose(left * [1, -1, 1], right)


@given(smooth_motions())
def test_mirror_is_a_reflection_and_its_own_inverse(motion):
    mirrored = motion.mirrored()
    swap = list(CANONICAL.mirror_index)
    np.testing.assert_allclose(
        mirrored.positions, motion.positions[:, swap] * [1.0, -1.0, 1.0], atol=1e-9
    )
    np.testing.assert_allclose(mirrored.mirrored().positions, motion.positions, atol=1e-12)


@given(smooth_motions())
def test_canonical_start_is_over_the_origin_facing_x_with_the_same_shape(motion):
    moved = motion.canonicalised()
    np.testing.assert_allclose(moved.root[0, :2], 0.0, atol=1e-12)
    assert abs(moved.heading[0]) < 1e-9
    np.testing.assert_allclose(moved.root[:, 2], motion.root[:, 2], atol=1e-12)
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(moved.positions, axis=0), axis=-1),
        np.linalg.norm(np.diff(motion.positions, axis=0), axis=-1),
        atol=1e-9,
    )


@given(smooth_motions())
def test_played_in_reverse_the_first_frame_is_the_last_and_twice_is_as_before(motion):
    backward = motion.reversed()
    np.testing.assert_array_equal(backward.positions, motion.positions[::-1])
    np.testing.assert_array_equal(backward.reversed().rotations, motion.rotations)


def test_resampling_passes_through_the_frames_and_keeps_bones():
    motion = waving(41, 20.0)
    fine = motion.resample(100.0)
    assert fine.frames == 201
    np.testing.assert_allclose(fine.positions[::5], motion.positions, atol=1e-9)
    forearm = np.linalg.norm(fine.joint("right_wrist") - fine.joint("right_elbow"), axis=1)
    np.testing.assert_allclose(forearm, 0.25, atol=1e-12)


def test_archive_round_trip(tmp_path):
    motion = waving()
    motion.save_npz(tmp_path / "m.npz")
    loaded = Motion.load_npz(tmp_path / "m.npz")
    np.testing.assert_allclose(loaded.positions, motion.positions, atol=1e-5)
    assert loaded.fps == motion.fps


def test_archive_of_something_else_is_refused(tmp_path):
    (tmp_path / "m.npz").write_bytes(b"not an archive")
    with pytest.raises(MotionFileError, match=r"m\.npz"):
        Motion.load_npz(tmp_path / "m.npz")


def test_parts_hold_every_joint_once():
    joints = [joint for part in PARTS.values() for joint in part]
    assert sorted(joints) == sorted(CANONICAL.names)


def test_wrong_shapes_are_refused():
    with pytest.raises(ValueError, match="22 joints"):
        Motion(np.zeros((4, 3)), rot.identity(4, 21), 20.0)
