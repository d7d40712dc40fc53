"""A sole that moves clears the floor, one that stands or is high enough stays."""

import numpy as np

from motiondiffuse_ros.physics.repair.swing import smooth_cover, swing_lift

FPS = 20.0


def sole(speed: np.ndarray, height: float) -> np.ndarray:
    """Return corners [T, 4, 3] of a level sole that moves ahead with a speed [T], m/s."""
    corners = np.zeros((len(speed), 4, 3))
    corners[..., :2] = [[-0.1, -0.04], [-0.1, 0.04], [0.1, -0.04], [0.1, 0.04]]
    corners[..., 0] += np.cumsum(speed)[:, None] / FPS
    corners[..., 2] = height
    return corners


def test_a_grazing_step_is_lifted_by_its_speed_and_meets_its_stances_smoothly():
    contact = np.ones(30, bool)
    contact[10:20] = False
    lift = swing_lift(sole(np.where(contact, 0.0, 2.0), 0.0), contact, FPS)
    assert (lift[contact] == 0.0).all()
    assert (lift[~contact] > 0.005).all()
    assert np.isclose(lift[14], 0.02)
    assert np.abs(np.diff(lift)).max() < 0.013


def test_a_step_that_clears_the_floor_stays():
    assert not swing_lift(sole(np.full(20, 2.0), 0.05), np.zeros(20, bool), FPS).any()


def test_a_foot_that_rolls_is_not_lifted():
    rolling = sole(np.zeros(20), 0.0)
    rolling[:, :2, 0] += np.linspace(0.0, 0.5, 20)[:, None]
    assert not swing_lift(rolling, np.zeros(20, bool), FPS).any()


def test_a_smooth_cover_is_nowhere_below_what_it_covers():
    values = np.random.default_rng(0).random(50)
    assert (smooth_cover(values, 2) >= values - 1e-12).all()
