"""When a path is passed: slower where a joint would be too fast, and to rest at its end."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import convolve1d, maximum_filter1d

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.spans import pieces

_STEP = 0.005
_HALO = 0.1
_KNOTS = 4096
"""Looked at together: speeds of all joints at all knots of a long path would take the most memory
of all."""


def slow_down(
    path: Callable[..., Array], end: float, limits: Array
) -> tuple[PchipInterpolator, float]:
    """Find the time at which each point of a path may be passed.

    Args:
        path: Joint positions [N, J] at path times [N], rad, or their nth derivative.
        end: Path time at the end [s].
        limits: Largest speeds [J], rad/s.

    Returns:
        Path time as a function of the new time, C1 and increasing, and the new time at the end.
        Where no joint is too fast the path keeps its pace.
    """
    knots = np.linspace(0.0, end, max(2, round(end / _STEP) + 1))
    some = (knots[at] for at in pieces(len(knots), _KNOTS))
    excess = np.concatenate([np.max(np.abs(path(at, 1)) / limits, axis=1) for at in some])
    pace = np.maximum(1.0, excess)
    # widen, then smooth over the same width: never below what is needed, and C1
    width = 2 * max(1, round(_HALO / _STEP)) + 1
    window = np.hanning(width + 2)[1:-1]
    pace = convolve1d(maximum_filter1d(pace, width), window / window.sum(), mode="nearest")
    steps = 0.5 * (pace[1:] + pace[:-1]) * np.diff(knots)
    times = np.concatenate([[0.0], np.cumsum(steps)])
    return PchipInterpolator(times, knots), float(times[-1])


def come_to_rest(times: Array, end: float, window: float) -> Array:
    """Warp time so that its pace goes smoothly from 1 to 0 over the last `window`.

    The pace is 1 - smootherstep, which integrates to one half: of the path's last `window`
    seconds the second half is given up.

    Args:
        times: New time [N], at most `end`, s.
        end: New time at rest [s].
        window: Length of the slow-down [s], at most `end`.

    Returns:
        Path times [N], s; the last pace, its slope and its curvature are zero.
    """
    if window <= 0.0:
        return times
    u = np.clip((times - (end - window)) / window, 0.0, 1.0)
    # integral of 1 - (6 u^5 - 15 u^4 + 10 u^3)
    travelled = u - (u**6 - 3.0 * u**5 + 2.5 * u**4)
    return np.minimum(times, end - window) + window * travelled
