"""Offsets run through their knots, also after the horizon has moved on."""

import numpy as np

from motiondiffuse_ros.physics.tracking.offsets import OffsetPath, corrected_hinges

TIMES = np.arange(100) * 0.005


def test_a_path_runs_linearly_from_its_start_through_its_knots():
    path = OffsetPath.over((0.1, 0.2), TIMES)
    offsets = path.offsets(np.array([1.0]), np.array([[[3.0], [2.0]]]))[0, :, 0]
    np.testing.assert_allclose(offsets[[0, 10, 20, 30, 40, 99]], [1.0, 2.0, 3.0, 2.5, 2.0, 2.0])


def test_a_moved_path_goes_on_where_it_was():
    path = OffsetPath.over((0.1, 0.2, 0.3), TIMES)
    rng = np.random.default_rng(0)
    start, values = rng.normal(size=2), rng.normal(size=(3, 2))
    before = path.offsets(start, values[None])[0]
    start, values = path.moved_on(start, values, 0.1)
    after = path.offsets(start, values[None])[0]
    np.testing.assert_allclose(after[:41], before[20:61], atol=1e-12)


def test_later_knots_have_no_effect_earlier():
    path = OffsetPath.over((0.1, 0.2, 0.3), TIMES)
    assert [path.knots_before(t) for t in (0.05, 0.1, 0.15, 0.25, 0.4)] == [1, 1, 2, 3, 3]


def test_both_sides_are_corrected_alike():
    hinges, scales = corrected_hinges()
    assert len(hinges) == len(scales) == 19
    assert (scales > 0.0).all()
