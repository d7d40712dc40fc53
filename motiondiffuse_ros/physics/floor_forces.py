"""The forces of a floor that come nearest to a wrench, for all frames of a motion at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion.rotations import Array, cross

FRICTION = 1.0
"""Coefficient of the friction cones (shoes on a dry floor)."""

_EDGES = np.array([[FRICTION, 0, 1], [-FRICTION, 0, 1], [0, FRICTION, 1], [0, -FRICTION, 1]])
# spreads the load over the points that could carry it; without, any one of many answers comes
_SPREAD = 0.02
_STEPS, _HALVINGS, _TOLERANCE = 60, 8, 1e-7
_STILL_GOING = 0.7
"""Share of frames that are not done below which the others are put aside."""


def floor_forces(needed: Array, arms: Array, touching: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Find what pushes inside four-edged friction cones can give of a wrench.

    Minimises |A x - b|^2 + s^2 |x|^2 over x >= 0, A being the cones' edges and b the wrench. Its
    dual has six unknowns a frame, the residual: x = max(A' residual, 0) / s^2, and is solved by
    Newton's method on all frames together, far faster than non-negative least squares on each.

    Args:
        needed: Force and torque [T, 6] in units of about 1, such as body weights.
        arms: Points relative to that about which the torque is [T, P, 3], m.
        touching: Which of them may push [T, P].

    Returns:
        The wrench that is left [T, 6], and the push at each point [T, P, 3], in the same units.
    """
    frames, points = touching.shape
    count = points * len(_EDGES)
    edges = np.broadcast_to(_EDGES, (frames, points, *_EDGES.shape))
    columns = np.concatenate([edges, cross(arms[:, :, None], edges)], axis=-1)
    columns = (columns * touching[..., None, None]).reshape(frames, count, 6) / _SPREAD
    left = _residual(needed, columns)
    push = np.maximum(columns @ left[..., None], 0.0)[..., 0] / _SPREAD
    return left, push.reshape(frames, points, len(_EDGES)) @ _EDGES


def _residual(needed: Array, columns: Array) -> Array:
    """Return the minimum of each frame's dual [T, 6], by Newton's method."""
    found = needed.copy()
    going = np.arange(len(needed))
    left = found
    for _ in range(_STEPS):
        push = np.maximum(columns @ left[..., None], 0.0)
        slope = left - needed + (push.swapaxes(1, 2) @ columns)[:, 0]
        on = np.abs(slope).max(axis=1, initial=0.0) >= _TOLERANCE
        if not on.any():
            break
        if on.mean() < _STILL_GOING:  # most frames need far fewer steps than the last one
            found[going] = left
            going, left, needed, columns = going[on], left[on], needed[on], columns[on]
            push, slope = push[on], slope[on]
        active = columns * (push > 0.0)
        curvature = np.eye(6) + active.swapaxes(1, 2) @ columns
        step = np.linalg.solve(curvature, slope[..., None])[..., 0]
        left = _descend(left, step, slope, needed, columns)
    found[going] = left
    return found


def _descend(left: Array, step: Array, slope: Array, needed: Array, columns: Array) -> Array:
    """Take as much of each frame's step as lowers its cost."""

    def cost(at: Array) -> Array:
        push = np.maximum(columns @ at[..., None], 0.0)[..., 0]
        return 0.5 * (at**2).sum(-1) - (needed * at).sum(-1) + 0.5 * (push**2).sum(-1)

    share = np.ones(len(left))
    start, fall = cost(left), 1e-4 * (slope * step).sum(-1)
    for _ in range(_HALVINGS):
        worse = cost(left - share[:, None] * step) > start - share * fall
        if not worse.any():
            break
        share[worse] *= 0.5
    return left - share[:, None] * step
