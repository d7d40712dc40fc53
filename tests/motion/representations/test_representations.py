import numpy as np
import pytest
from hypothesis import given, settings
from synthetic import drifting, moved, smooth_motions, turned, waving

from motiondiffuse_ros.motion import PARTS, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.features import REPRESENTATIONS, PoseState

ALL = [pytest.param(r(), id=name) for name, r in REPRESENTATIONS.items()]
SIZES = {
    "pose_state": 269,
    "humanml3d": 263,
    "kit_ml": 251,
    "joint_positions": 66,
    "root_rotations": 135,
}
# bones of other lengths or joints that are not there move what is decoded a little
TOLERANCE = {"humanml3d": 0.02, "kit_ml": 0.02}


def _turning_walk() -> Motion:
    motion = drifting(waving(50), 1.2)
    rotations = motion.rotations.copy()
    turned(rotations, "pelvis", 2, 0.02 * np.arange(50))
    return Motion(motion.root, rotations, motion.fps)


@pytest.mark.parametrize("representation", ALL)
def test_has_the_published_size_and_its_blocks_fill_it(representation):
    assert representation.dim == SIZES[representation.name]
    assert representation.encode(waving(5)).shape == (5, representation.dim)
    ends = [(s.start, s.stop) for s in representation.groups().values()]
    assert [e for _, e in ends] == [s for s, _ in ends[1:]] + [representation.dim]


@pytest.mark.parametrize("representation", ALL)
def test_decode_gives_the_motion_back(representation):
    motion = _turning_walk()
    found = representation.decode(representation.encode(motion), motion.fps)
    expected = motion.canonicalised()
    error = np.linalg.norm(found.positions - expected.positions, axis=-1).max()
    assert error < TOLERANCE.get(representation.name, 1e-4)
    assert found.fps == motion.fps


@pytest.mark.parametrize("representation", ALL)
@settings(deadline=None, max_examples=10)
@given(motion=smooth_motions())
def test_mirrored_features_decode_to_the_mirrored_motion(representation, motion):
    index, sign = representation.mirror()
    features = representation.encode(motion)
    found = representation.decode(features[:, index] * sign, motion.fps)
    mirrored = representation.decode(features, motion.fps).mirrored()
    np.testing.assert_allclose(found.positions, mirrored.positions, atol=1e-4)
    np.testing.assert_array_equal((features[:, index] * sign)[:, index] * sign, features)


@pytest.mark.parametrize("representation", ALL)
def test_the_mirror_of_the_features_is_near_those_of_the_mirror(representation):
    motion = _turning_walk()
    index, sign = representation.mirror()
    mirrored = representation.encode(motion)[:, index] * sign
    near = 0.05 * np.abs(mirrored).max(axis=0).clip(1.0)  # HumanML3D's legs are not of one length
    assert (np.abs(mirrored - representation.encode(motion.mirrored())) <= near).all()


@pytest.mark.parametrize("representation", ALL)
def test_parts_own_every_feature_once(representation):
    owned = np.concatenate([representation.part_indices(part) for part in PARTS])
    np.testing.assert_array_equal(np.sort(owned), np.arange(representation.dim))


@pytest.mark.parametrize("representation", ALL)
def test_an_arm_owns_what_its_rotation_changes(representation):
    motion = waving(5)
    rotations = motion.rotations.copy()
    turned(rotations, "left_elbow", 2, 0.5)
    turned(rotations, "left_shoulder", 0, 0.7)
    other = Motion(motion.root, rotations, motion.fps)
    changed = np.abs(representation.encode(other) - representation.encode(motion)).max(axis=0)
    owned = representation.part_indices("left_arm")
    assert set(np.flatnonzero(changed > 1e-4)) <= set(owned)
    assert (changed[owned] > 1e-4).any()


@pytest.mark.parametrize("representation", ALL)
def test_place_and_direction_do_not_matter(representation):
    motion = _turning_walk()
    turn = rot.about_axis(2, np.array(1.3))
    rotations = motion.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    there = Motion(rot.rotate(turn, motion.root), rotations, motion.fps)
    elsewhere = moved(there, np.array([3.0, -1.0, 0.0]))
    # in units of KIT-ML, float32 ends at a thousandth
    np.testing.assert_allclose(
        representation.encode(elsewhere), representation.encode(motion), atol=2e-3
    )


def test_an_unknown_part_is_refused():
    with pytest.raises(KeyError, match="left_arm"):
        PoseState().part_indices("tail")
