"""Feet that move over the floor do not graze it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, maximum_filter1d, uniform_filter1d

from motiondiffuse_ros.motion.rotations import Array

_CLEARANCE = 0.01
"""Height [m] of a sole's lowest corner for each m/s of its slowest one.

Of the feet in 300 level clips of the training split (docs/physics.md) three quarters and more are
that high at 1 to 5 m/s: 24 mm at 1 m/s, 33 at 2, 49 at 4 of CMU's, 8, 11 and 27 of Bandai-Namco's.
"""

_HIGHEST = 0.04  # m, of the clearance asked for
_RISE = 0.24  # m/s, by which a foot that leaves or nears its stance may be lifted more
_SMOOTHED = 1  # frames to either side


def swing_lift(corners: Array, contact: NDArray[np.bool_], fps: float) -> Array:
    """Return by how much a sole has to be higher [T], m, to clear the floor where it moves.

    Args:
        corners: Of the sole over time [T, C, 3], m.
        contact: Whether it stands [T]; there it is not lifted.
        fps: Frames per second.
    """
    step = np.linalg.norm(np.diff(corners[..., :2], axis=0), axis=-1).min(axis=1) * fps
    speed = np.maximum(np.append(step, step[-1:]), np.append(step[:1], step))
    clearance = np.minimum(_CLEARANCE * speed, _HIGHEST)
    if contact.any():
        most = _RISE / fps * np.asarray(distance_transform_edt(~contact))
    else:
        most = np.full(len(contact), np.inf)
    missing = np.minimum(clearance, most) - corners[..., 2].min(axis=1)
    return np.minimum(smooth_cover(np.maximum(missing, 0.0), _SMOOTHED), most)


def smooth_cover(values: Array, frames: int) -> Array:
    """Return a smooth curve that is nowhere below the values.

    Args:
        values: Over time [T].
        frames: It looks ahead and back.
    """
    covered = maximum_filter1d(values, 2 * frames + 1, mode="nearest")
    return uniform_filter1d(covered, 2 * frames + 1, mode="nearest")
