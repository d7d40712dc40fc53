"""Which foot carries the body when."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.spans import runs


@dataclass(frozen=True)
class ContactRule:
    """When a foot counts as standing on the floor.

    Attributes:
        support_height: The lower foot stands if its sole is lower than this [m]; between them and
            the flight of a jump nothing lies, since a body on the floor needs a foot on it.
        height: The other foot stands if its sole is lower than this [m].
        speed: And if the corner of the sole that moves least is slower than this [m/s].
        shortest: Runs of fewer frames are no contact, and gaps of fewer no step.
    """

    support_height: float = 0.06
    height: float = 0.03
    speed: float = 0.75
    shortest: int = 2


def foot_contacts(corners: Array, fps: float, rule: ContactRule) -> NDArray[np.bool_]:
    """Return which feet stand [T, 2].

    Args:
        corners: Of both soles over time [T, 2, C, 3], m.
        fps: Frames per second.
        rule: What counts.
    """
    lowest = corners[..., 2].min(axis=2)
    slow = _slowest_corner(corners, fps) < rule.speed
    lower = lowest <= lowest.min(axis=1, keepdims=True) + 0.005
    low = (lowest < rule.height) | (lower & (lowest < rule.support_height))
    contacts = low & slow
    for foot in range(contacts.shape[1]):
        contacts[:, foot] = _without_short_runs(contacts[:, foot], rule.shortest)
    return contacts


def _slowest_corner(corners: Array, fps: float) -> Array:
    """Return the horizontal speed, around each frame, of the slowest low corner [T, 2], m/s."""
    step = np.linalg.norm(np.diff(corners[..., :2], axis=0), axis=-1) * fps
    heights = corners[..., 2]
    low = heights < heights.min(axis=2, keepdims=True) + 0.02
    slowest = np.min(step, axis=2, where=low[:-1] | low[1:], initial=np.inf)
    return np.minimum(
        np.concatenate([slowest[:1], slowest]), np.concatenate([slowest, slowest[-1:]])
    )


def _without_short_runs(flags: NDArray[np.bool_], shortest: int) -> NDArray[np.bool_]:
    out = flags.copy()
    for start, stop in runs(~out):
        if stop - start < shortest and start > 0 and stop < len(out):
            out[start:stop] = True
    for start, stop in runs(out):
        if stop - start < shortest:
            out[start:stop] = False
    return out
