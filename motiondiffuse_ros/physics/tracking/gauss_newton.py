"""Steps towards the least sum of squares, from residuals at random points alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from motiondiffuse_ros.motion.rotations import Array

_RIDGE = 1e-3
# Levenberg-Marquardt damping in shares of the mean curvature, and lengths of the steps
_DAMPINGS = (0.0, 0.03, 0.1, 0.3, 1.0, 3.0)
_LENGTHS = (0.35, 0.7, 1.0)


@dataclass(frozen=True, eq=False)
class Quadratic:
    """Half the cost about a point, to second order; D variables.

    Attributes:
        gradient: [D].
        curvature: Gauss-Newton approximation of the Hessian [D, D].
    """

    gradient: Array = field(repr=False)
    curvature: Array = field(repr=False)

    def steps(self) -> Array:
        """Return steps [n, D] of several lengths and dampings."""
        size = len(self.gradient)
        mean = np.trace(self.curvature) / size
        full = [
            np.linalg.solve(self.curvature + damping * mean * np.eye(size), -self.gradient)
            for damping in _DAMPINGS
        ]
        return np.array([length * step for step in full for length in _LENGTHS])

    def covariance_root(self) -> Array:
        """Return the root [D, D] of the inverse curvature, scaled to a mean variance of 1."""
        values, vectors = np.linalg.eigh(self.curvature)
        variances = 1.0 / (values + values.mean())
        return vectors * np.sqrt(variances / variances.mean()) @ vectors.T


def fit_quadratic(
    moves: Array,
    changes: Array,
    residuals: Array,
    reached: Sequence[int],
    mean: Array,
    weight: float,
) -> Quadratic:
    """Fit residuals linearly to samples, and build the quadratic of their squares.

    A fit over samples of some spread is the derivative of the smoothed residual: contact that
    switches within that spread still has one (Suh et al. 2022, Pang et al. 2023).

    Args:
        moves: Differences of the samples from the mean [n, D].
        changes: What they change [n, R, F]: R times, F residuals each.
        residuals: At the mean [R, F].
        reached: How many of the first variables can have changed the residuals of each time [R].
        mean: [D].
        weight: Of the squares of the variables themselves.
    """
    size = moves.shape[1]
    gradient, curvature = weight * mean, weight * np.eye(size)
    for time, columns in enumerate(reached):
        x = moves[:, :columns]
        normal = x.T @ x
        normal += _RIDGE * np.trace(normal) / columns * np.eye(columns)
        slopes = np.linalg.solve(normal, x.T @ changes[:, time])
        gradient[:columns] += slopes @ residuals[time]
        curvature[:columns, :columns] += slopes @ slopes.T
    return Quadratic(gradient, curvature)


def antithetic_directions(generator: np.random.Generator, count: int, size: int) -> Array:
    """Return random directions [2 count, size] of unit variance, each with its opposite.

    They are orthogonal in blocks of `size`, so that few of them span the space.
    """
    blocks = -(-count // size)
    turns = np.linalg.qr(generator.normal(size=(blocks, size, size)))[0]
    directions = np.sqrt(size) * turns.reshape(-1, size)[:count]
    return np.concatenate([directions, -directions])
