"""Tracking by sampling keeps a body up that would fall, and always in the same way."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import moved, standing, waving

from motiondiffuse_ros.errors import Cancelled, PhysicsError
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.tracking import SamplingConfig, track_by_sampling

QUICK = SamplingConfig(
    horizon=0.3,
    knots=(0.1, 0.2),
    directions=24,
    iterations=1,
    most_iterations=1,
    retries=1,
    threads=1,
)
WEIGHT = 70.0 * 9.81


@pytest.fixture(scope="module")
def executed():
    return track_by_sampling(waving(21), QUICK)


def test_a_gesture_is_executed_to_its_end(executed):
    assert executed.success
    assert executed.time_to_fall == waving(21).duration
    assert executed.motion.frames == 21
    assert executed.motion.fps == waving(21).fps
    assert executed.mpjpe < 30.0
    assert executed.mpjpe <= executed.largest_error


def test_it_stands_on_its_own_feet(executed):
    assert (np.abs(executed.torques) <= hinge_table().torque_limits + 1e-9).all()
    supplied = executed.contact_forces[..., 2].sum(axis=1)
    assert supplied.mean() == pytest.approx(WEIGHT, rel=0.1)
    on_feet = executed.contact_forces[:, [7, 8, 10, 11], 2].sum()
    assert on_feet == pytest.approx(executed.contact_forces[..., 2].sum())


def test_threads_do_not_change_the_result(executed):
    again = track_by_sampling(waving(21), replace(QUICK, threads=2))
    assert np.array_equal(again.qpos, executed.qpos)
    assert np.array_equal(again.torques, executed.torques)


def test_a_body_asked_to_hover_falls():
    tracked = track_by_sampling(moved(standing(41), np.array([0.0, 0.0, 1.0])), QUICK)
    assert not tracked.success
    assert 0.2 < tracked.time_to_fall < 0.6
    assert tracked.motion.frames == int(tracked.time_to_fall * 20.0) + 1


def test_it_can_be_cancelled_and_tells_its_progress():
    shares: list[float] = []
    with pytest.raises(Cancelled):
        track_by_sampling(
            standing(60), QUICK, cancelled=lambda: len(shares) == 2, progress=shares.append
        )
    assert shares == pytest.approx([0.1 / 2.95, 0.2 / 2.95], abs=1e-3)


def test_what_cannot_be_tracked_is_refused():
    with pytest.raises(PhysicsError, match=r"0\.1 s or more"):
        track_by_sampling(standing(1), QUICK)
    broken = moved(standing(21), np.full(3, np.nan))
    with pytest.raises(PhysicsError, match="finite"):
        track_by_sampling(broken, QUICK)


@pytest.mark.parametrize(
    "change",
    [
        {"horizon": 0.05},
        {"knots": (0.2, 0.1)},
        {"knots": (0.9,)},
        {"directions": 0},
        {"threads": 0},
        {"spread": float("nan")},
        {"most_iterations": 0},
        {"retries": -1},
        {"lost": 0.0},
    ],
)
def test_senseless_settings_are_refused(change):
    with pytest.raises(PhysicsError):
        track_by_sampling(standing(21), replace(QUICK, **change))
