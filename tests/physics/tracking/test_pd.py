"""The PD controller holds up what can be held up, and nothing else."""

import numpy as np
import pytest
from hypothesis import given, settings
from synthetic import moved, smooth_motions, standing, waving

from motiondiffuse_ros.errors import Cancelled, PhysicsError
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.tracking import track


def test_standing_and_waving_stay_up():
    for motion in (standing(60), waving(60)):
        tracked = track(motion)
        assert not tracked.fell
        assert tracked.time_to_fall == motion.duration
        assert tracked.mpjpe < 20.0


def test_a_long_motion_is_tracked_to_its_end():
    motion = waving(400)
    tracked = track(motion)
    assert tracked.time_to_fall == motion.duration
    assert len(tracked.qpos) == 100 * motion.duration + 1


def test_a_body_asked_to_hover_falls():
    tracked = track(moved(standing(60), np.array([0.0, 0.0, 1.0])))
    assert tracked.fell
    assert 0.2 < tracked.time_to_fall < 0.6


def test_torques_stay_inside_their_limits():
    assert (np.abs(track(waving(40)).torques) <= hinge_table().torque_limits + 1e-9).all()


def test_the_same_motion_ends_the_same():
    a, b = track(waving(40)), track(waving(40))
    assert np.array_equal(a.qpos, b.qpos)


def test_it_can_be_cancelled_and_tells_its_progress():
    shares: list[float] = []
    with pytest.raises(Cancelled):
        track(standing(60), cancelled=lambda: len(shares) == 10, progress=shares.append)
    assert shares == sorted(shares)
    assert 0.0 < shares[-1] < 0.1


@settings(max_examples=5, deadline=None)
@given(smooth_motions(max_amplitude=3.0))
def test_wild_motions_end_in_a_fall_not_in_a_crash(motion):
    if motion.duration < 0.1:
        with pytest.raises(PhysicsError, match=r"0\.1 s"):
            track(motion)
        return
    tracked = track(motion)
    assert np.isfinite(tracked.qpos).all()
    assert 0.0 < tracked.time_to_fall <= motion.duration
