"""Steps from samples alone find what linear algebra finds with the derivative."""

import numpy as np

from motiondiffuse_ros.physics.tracking.gauss_newton import (
    antithetic_directions,
    fit_quadratic,
)


def test_linear_residuals_are_solved_in_one_step():
    rng = np.random.default_rng(0)
    slopes, offset = rng.normal(size=(2, 5, 6)), rng.normal(size=(2, 5))
    moves = antithetic_directions(rng, 6, 6)
    quadratic = fit_quadratic(
        moves,
        np.einsum("rfd,nd->nrf", slopes, moves),
        offset,
        (6, 6),
        np.zeros(6),
        1e-9,
    )
    best, *_ = np.linalg.lstsq(slopes.reshape(10, 6), -offset.ravel(), rcond=None)
    errors = np.linalg.norm(quadratic.steps() - best, axis=1)
    assert errors.min() < 0.02 * np.linalg.norm(best)


def test_what_comes_later_cannot_change_what_is_earlier():
    moves = antithetic_directions(np.random.default_rng(1), 4, 4)
    quadratic = fit_quadratic(
        moves, np.ones((8, 1, 1)) * moves[:, 3, None, None], np.ones((1, 1)), (2,), np.zeros(4), 1.0
    )
    assert not quadratic.gradient[2:].any()
    assert np.array_equal(quadratic.curvature[2:], np.eye(4)[2:])


def test_directions_come_with_their_opposites_and_span_the_space():
    directions = antithetic_directions(np.random.default_rng(2), 7, 5)
    assert directions.shape == (14, 5)
    assert np.array_equal(directions[:7], -directions[7:])
    np.testing.assert_allclose(directions[:5] @ directions[:5].T, 5.0 * np.eye(5), atol=1e-12)


def test_the_covariance_is_wide_where_the_cost_is_flat():
    moves = antithetic_directions(np.random.default_rng(3), 2, 2)
    changes = moves[:, None, :] * np.array([10.0, 0.1])
    quadratic = fit_quadratic(moves, changes, np.zeros((1, 2)), (2,), np.zeros(2), 1e-6)
    root = quadratic.covariance_root()
    assert root[1, 1] > 1.3 * root[0, 0]
