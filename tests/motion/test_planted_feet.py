import numpy as np
import pytest
import torch
from synthetic import moved, standing

from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.planted_feet import PlantedFeet
from motiondiffuse_ros.motion.skeleton import CANONICAL, SIDES

STATE = PoseState()
GROUPS = STATE.groups()
PLANAR, HEIGHT = GROUPS["root_velocity"], GROUPS["root_height"]


def _planted(features):
    return PlantedFeet(20.0)(torch.from_numpy(features).float()[None])[0].numpy()


def _clip(paths, name):
    path = next(p for p in paths if p.stem == name)
    return STATE.encode(load_motion(path).resample(20.0))


def _slide(features):
    """Return the mean speed [m/s] at which feet in contact move over the floor."""
    motion = STATE.decode(features, 20.0)
    feet = motion.positions[:, [CANONICAL.index(name) for name in CONTACT_JOINTS], :2]
    contact = features[1:, GROUPS["contacts"]] * features[:-1, GROUPS["contacts"]]
    speed = np.linalg.norm(np.diff(feet, axis=0), axis=-1) * 20.0
    return float((speed * contact).sum() / contact.sum())


@pytest.mark.parametrize("drift", [[0.0, 0.2], [0.2, 0.0]])
def test_feet_of_steps_that_are_too_short_stay_put_and_the_root_goes_its_way(real_paths, drift):
    features = _clip(real_paths, "02_01")
    drifting = features.copy()
    drifting[:, PLANAR] += drift
    planted = _planted(drifting)
    np.testing.assert_array_equal(planted[:, PLANAR], drifting[:, PLANAR].astype(np.float32))
    assert _slide(planted) < 0.5 * _slide(drifting)


@pytest.mark.parametrize("name", ["09_01", "dataset-2_run_normal_001"])
def test_a_runners_feet_are_hardly_held(real_paths, name):
    features = _clip(real_paths, name)
    features[:, PLANAR] += [0.0, 0.8]
    assert 0.25 * _slide(features) < _slide(_planted(features)) < _slide(features)


def test_no_foot_reaches_further_than_a_step():
    still = STATE.encode(standing(80))
    still[:, PLANAR] += [0.0, 1.0]
    change = (_planted(still) - still)[:, GROUPS["positions"]].reshape(80, -1, 3)
    assert 0.1 < np.linalg.norm(change[:, :, [0, 2]], axis=-1).max() < 0.25


def test_feet_in_the_air_hold_nothing():
    still = standing(40)
    flying = STATE.encode(moved(still, np.tile([0.0, 0.0, 0.5], (40, 1))))
    flying[:, PLANAR] += [0.3, 0.2]
    np.testing.assert_allclose(_planted(flying), flying, atol=1e-6)


def test_a_body_that_hovers_or_sinks_is_put_on_its_soles():
    still = standing(40)
    on_floor = STATE.encode(still)
    for height in (0.04, -0.04):
        away = STATE.encode(moved(still, np.tile([0.0, 0.0, height], (40, 1))))
        away[:, GROUPS["contacts"]] = on_floor[:, GROUPS["contacts"]]
        back = _planted(away)
        np.testing.assert_allclose(back[:, HEIGHT], on_floor[:, HEIGHT], atol=0.003)
        np.testing.assert_allclose(
            back[:, GROUPS["positions"]], on_floor[:, GROUPS["positions"]], atol=0.003
        )


def test_only_legs_bend_feet_keep_their_pitch_and_all_is_consistent(real_paths):
    features = _clip(real_paths, "02_01")
    features[:, PLANAR] += [0.1, 0.2]
    planted = _planted(features)
    for name in ("yaw_velocity", "contacts"):
        np.testing.assert_array_equal(planted[:, GROUPS[name]], features[:, GROUPS[name]])
    before, after = STATE.decode(features, 20.0), STATE.decode(planted, 20.0)
    bent = {f"{side}_{joint}" for side in SIDES for joint in ("hip", "ankle")}
    for j, name in enumerate(CANONICAL.names):
        change = np.abs(after.rotations[:, j] - before.rotations[:, j]).max()
        assert (change > 1e-3) == (name in bent), name
    feet = [CANONICAL.index(f"{side}_ankle") for side in SIDES]
    np.testing.assert_allclose(
        after.global_rotations[:, feet], before.global_rotations[:, feet], atol=1e-4
    )
    # places and velocities are those of the bent legs
    again = STATE.encode(after)
    for name, frames in (("positions", slice(None)), ("velocities", slice(-2))):
        expected = features[:, GROUPS[name]] - STATE.encode(before)[:, GROUPS[name]]
        np.testing.assert_allclose(
            planted[frames, GROUPS[name]] - again[frames, GROUPS[name]],
            expected[frames],
            atol=2e-2 if name == "velocities" else 1e-3,
        )


@pytest.mark.parametrize("frames", [1, 2])
def test_what_is_too_short_to_slide_is_left_alone(frames):
    features = STATE.encode(standing(frames))
    np.testing.assert_array_equal(_planted(features), features.astype(np.float32))


def test_what_is_not_finite_is_left_to_whoever_looks_for_it():
    broken = STATE.encode(standing(40))
    broken[7, 3] = np.nan
    np.testing.assert_array_equal(_planted(broken), broken.astype(np.float32))


def test_ten_minutes_take_no_more_than_their_parts(real_paths):
    """A system of equations over all frames, dense, would take gigabytes."""
    features = _clip(real_paths, "02_01")
    long = np.tile(features, (12000 // len(features) + 1, 1))
    planted = _planted(long)
    inner = slice(3 * len(features), 4 * len(features))
    assert _slide(planted[inner]) < 0.7 * _slide(long[inner])
