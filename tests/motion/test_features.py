import numpy as np
import torch
from hypothesis import given, settings
from synthetic import smooth_motions

from motiondiffuse_ros.corpus import load_motion
from motiondiffuse_ros.motion import PARTS
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.kinematics import PoseStateKinematics

STATE = PoseState()


def _errors(motion, decoded):
    """Return the largest position error [m] and rotation error [degrees]."""
    expected = motion.canonicalised()
    distance = np.linalg.norm(decoded.positions - expected.positions, axis=-1).max()
    angle = np.degrees(rot.angle_between(decoded.rotations, expected.rotations).max())
    return distance, angle


@settings(deadline=None, max_examples=50)
@given(smooth_motions())
def test_decode_inverts_encode(motion):
    distance, angle = _errors(motion, STATE.decode(STATE.encode(motion), motion.fps))
    assert distance < 1e-3
    assert angle < 0.1


def test_real_clips_survive_the_round_trip_within_a_millimetre(real_paths):
    for path in real_paths:
        motion = load_motion(path).resample(20.0)
        distance, angle = _errors(motion, STATE.decode(STATE.encode(motion), 20.0))
        assert distance < 1e-3, path
        assert angle < 0.1, path


@settings(deadline=None, max_examples=50)
@given(smooth_motions())
def test_mirrored_features_are_the_features_of_the_mirror_image(motion):
    index, sign = STATE.mirror()
    np.testing.assert_allclose(
        STATE.encode(motion)[:, index] * sign, STATE.encode(motion.mirrored()), atol=1e-4
    )


def test_parts_own_every_feature_once():
    owned = np.concatenate([STATE.part_indices(part) for part in PARTS])
    np.testing.assert_array_equal(np.sort(owned), np.arange(STATE.dim))


def test_features_do_not_depend_on_place_or_direction(real_paths):
    motion = load_motion(real_paths[0])
    turned = motion.canonicalised()
    np.testing.assert_allclose(STATE.encode(motion), STATE.encode(turned), atol=1e-4)


@settings(deadline=None, max_examples=25)
@given(smooth_motions())
def test_torch_kinematics_agree_with_the_encoded_positions(motion):
    features = STATE.encode(motion)
    positions = PoseStateKinematics().positions(torch.from_numpy(features))
    np.testing.assert_allclose(
        positions.flatten(1).numpy(), features[:, STATE.groups()["positions"]], atol=1e-4
    )
