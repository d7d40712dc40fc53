import numpy as np
import pytest
import torch
from synthetic import moved, standing

from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.kinematics import PoseStateKinematics
from motiondiffuse_ros.training.losses import MotionLoss

STATE = PoseState()
PLAIN = Statistics(np.zeros(STATE.dim, np.float32), np.ones(STATE.dim, np.float32))


def _features(motion):
    return torch.from_numpy(STATE.encode(motion)).float()


def _loss(predicted, true, fps, weight=1.0):
    lengths, weights = torch.tensor([len(true)]), torch.tensor([weight])
    return MotionLoss(STATE, PLAIN, fps)(predicted[None], true[None], lengths, 0, weights)


def test_velocities_by_kinematics_are_those_of_real_clips(real_paths):
    kinematics, groups = PoseStateKinematics(), STATE.groups()
    for path in (real_paths[0], real_paths[-1]):
        motion = load_motion(path)
        features = _features(motion)[:-1]
        here, there = (kinematics.positions(f) for f in (features[:-1], features[1:]))
        got = kinematics.velocities(features[:-1], here, there, motion.fps)
        true = features[:-1, groups["velocities"]].unflatten(1, (-1, 3))[:, 1:]
        torch.testing.assert_close(got, true, atol=2e-3, rtol=1e-3)


def test_truth_costs_nothing(real_paths):
    motion = load_motion(real_paths[0])
    features = _features(motion)[:-1]
    losses = _loss(features, features, motion.fps)
    for name in ("features", "difference", "plain"):
        assert getattr(losses, name).item() == 0.0
    for name in ("position", "velocity", "slide"):
        assert getattr(losses, name).item() < 1e-4


def test_a_root_that_glides_over_planted_feet_costs_its_speed():
    still = standing(41)
    times = np.arange(still.frames)[:, None] / still.fps
    gliding = _features(moved(still, times * [0.5, 0.0, 0.0]))
    # only what decides the decoded motion glides: the other blocks agree with the truth
    predicted = _features(still)
    root = STATE.groups()["root_velocity"]
    predicted[:, root] = gliding[:, root]
    losses = _loss(predicted, _features(still), still.fps)
    assert losses.slide.item() == pytest.approx(0.5, rel=1e-3)
    assert losses.velocity.item() == pytest.approx(0.5**2 / 3, rel=1e-3)
    assert losses.position.item() == pytest.approx(0.0, abs=1e-6)


def test_a_weight_scales_all_but_the_plain_loss(real_paths):
    motion = load_motion(real_paths[0])
    true = _features(motion)[:-1]
    predicted = true + 0.1 * torch.randn(true.shape, generator=torch.Generator().manual_seed(0))
    once, thrice = (vars(_loss(predicted, true, motion.fps, weight)) for weight in (1.0, 3.0))
    for name, value in once.items():
        factor = 1.0 if name == "plain" else 3.0
        torch.testing.assert_close(thrice[name], factor * value, rtol=1e-4, atol=1e-6)
