import numpy as np
import pytest
import torch
from synthetic import moved, standing

from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.planted_feet import PlantedFeet

STATE = PoseState()
GROUPS = STATE.groups()
PLANAR, HEIGHT = GROUPS["root_velocity"], GROUPS["root_height"]


def _planted(features):
    return PlantedFeet(20.0)(torch.from_numpy(features).float()[None])[0].numpy()


def _clip(paths, name):
    path = next(p for p in paths if p.stem == name)
    return STATE.encode(load_motion(path).resample(20.0))


@pytest.mark.parametrize("name", ["02_01", "dataset-2_wave-right-hand_normal_001"])
def test_a_root_that_drifts_over_standing_feet_is_held(real_paths, name):
    features = _clip(real_paths, name)
    drifting = features.copy()
    drifting[:, PLANAR] += [0.0, 0.3]
    held = _planted(drifting)[:, PLANAR] - features[:, PLANAR]
    assert np.abs(held[:, 1]).mean() < 0.12


def test_sideways_a_root_may_drift_but_not_shake():
    still = STATE.encode(standing(80))
    drifting, shaking = still.copy(), still.copy()
    drifting[:, PLANAR] += [0.3, 0.0]
    assert _planted(drifting)[:, PLANAR][:, 0].mean() > 0.25
    shaking[:, PLANAR.start] += 0.3 * np.sin(np.arange(80) * 2.0 * np.pi / 8.0)
    assert np.abs(_planted(shaking)[:, PLANAR][:, 0]).mean() < 0.1


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


def test_poses_stay_and_all_joints_follow_the_root(real_paths):
    features = _clip(real_paths, "02_01")
    features[:, PLANAR] += [0.1, 0.2]
    planted = _planted(features)
    for name in ("yaw_velocity", "rotations", "contacts"):
        np.testing.assert_array_equal(planted[:, GROUPS[name]], features[:, GROUPS[name]])
    change = planted - features
    places = change[:, GROUPS["positions"]].reshape(len(features), -1, 3)
    np.testing.assert_allclose(places[:, :, [0, 2]], 0.0, atol=1e-6)
    np.testing.assert_allclose(places[:, :, 1], np.tile(change[:, HEIGHT], (1, 21)), atol=1e-5)
    speeds = change[:, GROUPS["velocities"]].reshape(len(features), -1, 3)
    np.testing.assert_allclose(
        speeds[:, :, [0, 2]], np.tile(change[:, None, PLANAR], (1, 22, 1)), atol=1e-5
    )
    rise = np.diff(change[:, HEIGHT], axis=0) * 20.0
    np.testing.assert_allclose(speeds[:-1, :, 1], np.tile(rise, (1, 22)), atol=1e-4)


def test_a_single_frame_is_left_alone():
    features = STATE.encode(standing(1))
    np.testing.assert_array_equal(_planted(features), features.astype(np.float32))
