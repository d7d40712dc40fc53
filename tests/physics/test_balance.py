"""The capture point: inside the feet of who stands, caught by the next step of who walks."""

import numpy as np
import pytest

from motiondiffuse_ros.physics.balance import balance

SQUARE = np.array([[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, 0.1, 0], [-0.1, -0.1, 0]])


def _standing_at(x: float, frames: int = 10):
    centre = np.tile([x, 0.0, 0.981], (frames, 1))
    return centre, np.tile(SQUARE, (frames, 1, 1)), np.ones((frames, 4), dtype=bool)


@pytest.mark.parametrize(("x", "distance"), [(0.0, -0.1), (0.1, 0.0), (0.35, 0.25)])
def test_who_stands_is_as_far_out_as_the_centre_of_mass(x, distance):
    found = balance(*_standing_at(x), fps=20.0)
    assert found.from_support == pytest.approx(np.full(10, distance), abs=1e-3)
    assert found.from_next_step == pytest.approx(np.full(10, distance), abs=1e-3)


def test_who_moves_is_ahead_of_the_centre_of_mass():
    centre, places, touching = _standing_at(0.0, 3)
    centre[:, 0] = [-0.05, 0.0, 0.05]
    # 1 m/s at a height of 0.981 m leads by sqrt(0.1) m
    found = balance(centre, places, touching, fps=20.0)
    assert found.from_support[1] == pytest.approx(np.sqrt(0.1) - 0.1, abs=2e-3)


def test_a_walker_is_out_of_support_and_caught_by_the_next_step():
    frames = np.arange(60)
    centre = np.stack([0.05 * frames, 0.0 * frames, 0.0 * frames + 1.0], axis=-1)
    step = np.floor(frames / 12)
    places = SQUARE + np.stack([0.6 * step + 0.3, 0.0 * step, 0.0 * step], axis=-1)[:, None]
    found = balance(centre, places, np.ones((60, 4), dtype=bool), fps=20.0)
    assert found.from_support.max() > 0.2
    assert found.from_next_step[:40].max() < 0.05


def test_flight_has_no_support_now():
    centre, places, touching = _standing_at(0.0, 40)
    touching[10:14] = False
    found = balance(centre, places, touching, fps=20.0)
    assert np.isnan(found.from_support[10:14]).all()
    assert np.isfinite(found.from_next_step).all()
    touching[:] = False
    assert np.isnan(balance(centre, places, touching, fps=20.0).from_next_step).all()
