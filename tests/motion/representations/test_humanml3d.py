"""Against the one clip of HumanML3D that is published with its repository."""

import numpy as np
import pytest

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.features import HumanML3D
from motiondiffuse_ros.motion.frames import vectors_to_z_up
from motiondiffuse_ros.motion.from_positions import leg_length
from motiondiffuse_ros.motion.skeleton import LEG_LENGTH

HUMANML3D = HumanML3D()


@pytest.fixture(scope="module")
def sample(humanml3d_sample):
    """Published features [170, 263] and joints [170, 22, 3]."""
    features = np.load(humanml3d_sample / "new_joint_vecs" / "012314.npy")
    joints = np.load(humanml3d_sample / "new_joints" / "012314.npy")
    return features, joints.astype(float)


def test_the_published_joints_are_recovered(sample):
    features, joints = sample
    assert np.abs(HUMANML3D.positions(features) - joints).max() < 1e-5


def test_all_263_published_numbers_follow_from_the_joints(sample):
    features, joints = sample
    encoded = HUMANML3D.encode_positions(joints)
    # the published clip had one more frame, which the smoothed heading of the last ones saw
    np.testing.assert_allclose(encoded[:110], features[:110], atol=1e-4)
    np.testing.assert_allclose(encoded[110:-1], features[110:-1], atol=2e-2)


def test_the_motion_decoded_moves_as_the_published_joints_do(sample):
    features, joints = sample
    motion = HUMANML3D.decode(features, 20.0)
    published = vectors_to_z_up(joints)
    scaled = published * LEG_LENGTH / leg_length(published)
    error = np.linalg.norm(motion.positions - scaled, axis=-1)
    assert error.mean() < 0.05  # our shoulders and hips are 3 cm wider on each side
    for name in ("knee", "ankle", "foot", "elbow", "wrist"):
        for side in ("left", "right"):
            j = CANONICAL.index(f"{side}_{name}")
            bones = [p[:, j] - p[:, CANONICAL.parents[j]] for p in (motion.positions, published)]
            ours, theirs = map(rot.unit, bones)
            assert np.abs(ours - theirs).max() < 1e-5


def test_the_decoded_motion_stands_on_the_floor_and_faces_ahead(sample):
    motion = HUMANML3D.decode(sample[0], 20.0)
    assert np.abs(motion.root[0, :2]).max() < 0.05
    assert abs(motion.heading[0]) < 0.3
    assert 0.0 <= motion.positions[..., 2].min() < 0.05


def test_encoding_puts_our_motion_on_their_skeleton(sample):
    features, joints = sample
    again = HUMANML3D.positions(HUMANML3D.encode(HUMANML3D.decode(features, 20.0)))
    for j, parent in enumerate(CANONICAL.parents):
        if parent >= 0:
            ours, theirs = (
                np.linalg.norm(p[:, j] - p[:, parent], axis=-1) for p in (again, joints)
            )
            np.testing.assert_allclose(ours, theirs, atol=1e-4)
