"""Penetrate, float and skate against a body whose place over the floor is known."""

import numpy as np
import pytest
from synthetic import drifting, moved, standing

from motiondiffuse_ros.physics.ground_contact import ground_errors


@pytest.mark.parametrize(
    ("height", "penetrate", "float_"),
    [(0.0, 0, 0), (0.03, 0, 30), (-0.03, 30, 0), (0.004, 0, 0), (-0.004, 0, 0)],
)
def test_depth_counts_in_full_past_the_tolerance(height, penetrate, float_):
    errors = ground_errors(moved(standing(5), np.array([0.0, 0.0, height])))
    assert np.allclose(errors.penetrate, penetrate, atol=1e-6)
    assert np.allclose(errors.float_, float_, atol=1e-6)
    assert np.allclose(errors.lowest, height)


def test_skate_is_the_way_between_two_frames_in_contact():
    # 0.2 m/s at 20 fps
    assert np.allclose(ground_errors(drifting(standing(5), 0.2)).skate, [10, 10, 10, 10, 0])


def test_a_body_in_the_air_does_not_skate():
    hovering = moved(drifting(standing(5), 0.2), np.array([0.0, 0.0, 0.1]))
    assert not ground_errors(hovering).skate.any()


def test_phys_err_is_the_sum():
    errors = ground_errors(moved(drifting(standing(5), 0.2), np.array([0.0, 0.0, -0.03])))
    assert np.allclose(errors.phys_err, [40, 40, 40, 40, 30])
