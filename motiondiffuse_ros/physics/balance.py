"""Whether a body is where it can stay, or be caught by its next step.

The extrapolated centre of mass (Hof 2008), or capture point (Pratt et al. 2006), is where a foot
has to be for the body to come to rest on it: the centre of mass plus its velocity times the time
constant of an inverted pendulum of its height. Who stands keeps it over the feet. Who walks does
not: it leaves the feet that stand and the next step catches it. So there are two distances, one
from the feet that stand now, and one from all ground that the feet stand on within the next step.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.spans import pieces

STEP = 0.8
"""Within this time [s] a step has to come that catches the body."""

GRAVITY = 9.81
_LOWEST_CENTRE = 0.1
_ANGLES = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
# a convex hull is known by how far it reaches in each direction; 32 err by less than 0.5 %
_DIRECTIONS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=-1)


_FRAMES = 1024
"""At once: all points in all directions are many numbers."""


@dataclass(frozen=True, eq=False)
class Balance:
    """Distances of the capture point, negative inside.

    Attributes:
        from_support: From the hull of what touches the floor [T], m; NaN in flight.
        from_next_step: From the hull of what touches it in the `STEP` around each frame [T], m;
            NaN where nothing does.
    """

    from_support: Array = field(repr=False)
    from_next_step: Array = field(repr=False)


def balance(centre: Array, places: Array, touching: NDArray[np.bool_], fps: float) -> Balance:
    """Measure a body's balance.

    Args:
        centre: Centre of mass over time [T, 3], m, floor at z = 0.
        places: Points of the body [T, P, 3], m.
        touching: Which of them touch the floor [T, P].
        fps: Frames per second.
    """
    velocity = np.gradient(centre[:, :2], 1.0 / fps, axis=0)
    height = np.maximum(centre[:, 2:], _LOWEST_CENTRE)
    capture = centre[:, :2] + velocity * np.sqrt(height / GRAVITY)
    used = np.flatnonzero(touching.any(axis=0))
    at_once = pieces(len(places), _FRAMES)
    support = np.concatenate([_reach(places[at][:, used], touching[at][:, used]) for at in at_once])
    window = 2 * round(STEP * fps) + 1
    soon = maximum_filter1d(support, window, axis=0, mode="nearest")
    own = capture @ _DIRECTIONS.T
    return Balance(_outside(own, support), _outside(own, soon))


def _reach(places: Array, touching: NDArray[np.bool_]) -> Array:
    """Return how far what touches the floor reaches in each direction [T, 32]."""
    every = places[..., :2] @ _DIRECTIONS.T
    return np.max(every, axis=1, where=touching[..., None], initial=-np.inf)


def _outside(own: Array, support: Array) -> Array:
    known = np.isfinite(support.sum(axis=1))
    return np.where(known, np.max(own - np.where(known[:, None], support, 0.0), axis=1), np.nan)
