"""GMD's skating ratio and the speed of the corner of the sole that moves least."""

import numpy as np
import pytest
from synthetic import drifting, moved, standing, turned

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.foot_skating import foot_skating


@pytest.mark.parametrize(("speed", "skates"), [(0.0, False), (0.4, False), (0.8, True)])
def test_a_gliding_body_skates_above_half_a_metre_a_second(speed, skates):
    found = foot_skating(drifting(standing(40), speed))
    # GMD's average over five frames starts and ends low
    assert (found.ratio > 0.8) == skates
    assert (found.contact_ratio > 0.8) == skates
    assert np.allclose(found.slide_speed, speed)


def test_no_foot_is_in_contact_in_the_air():
    found = foot_skating(moved(drifting(standing(20), 1.0), np.array([0.0, 0.0, 0.2])))
    assert found.ratio == found.contact_ratio == 0.0
    assert np.isnan(found.slide_speed).all()
    assert not found.support_slide.any()


def test_a_foot_that_pivots_on_a_corner_does_not_slide():
    still = standing(20)
    rotations = still.rotations.copy()
    turned(rotations, "pelvis", 2, np.linspace(0.0, 0.5, 20))
    spun = Motion(still.root, rotations, still.fps)
    # turn about the left foot's heel, not about the pelvis
    from motiondiffuse_ros.physics.geometry import sole_probes

    corner = sole_probes("left").centres(spun)[:, 0]
    pivoting = moved(spun, corner[0] - corner)
    assert foot_skating(pivoting).support_slide.max() < 1e-9
