"""Where a robot's feet go: along the scaled path of the skeleton's, but at rest where they stand.

A foot that stands rolls over its heel, its whole sole or its toes without sliding. Where it stands
differs a little from the scaled path, since the robot's foot has another shape; the difference is
made up in the swing.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import binary_closing, binary_opening, gaussian_filter1d

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS, detect_contacts
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES, TOE_HEIGHT
from motiondiffuse_ros.motion.spans import runs
from motiondiffuse_ros.physics.geometry import sole_probes
from motiondiffuse_ros.robots.embodiment import Embodiment

LEAST_STANCE = 0.1
"""Shorter contacts are none, and shorter gaps in one are contact [s]."""

LONGEST_CORRECTION = 0.08
"""A foot is moved off its scaled path by no more than this, in parts of the leg's scale [m].

Feet that glide farther than this in contact do so on purpose, or by a fault that is not ours.
"""

_SMOOTHING = 0.06
"""Standard deviation over which levelling and lowering set in and end [s]."""


@dataclass(frozen=True, eq=False)
class FootPath:
    """Of one foot.

    Attributes:
        ankle: Of the robot [T, 3], m.
        rotation: Of the foot, from its T-pose [T, 4], wxyz.
        grip: From 0 in the air to 1 where it bears on heel or toes [T].
    """

    ankle: Array = field(repr=False)
    rotation: Array = field(repr=False)
    grip: Array = field(repr=False)


def foot_paths(motion: Motion, body: Embodiment) -> dict[str, FootPath]:
    """Return the paths of both feet."""
    contacts = _cleaned(detect_contacts(motion), motion.fps)
    return {side: _foot_path(motion, body, side, contacts) for side in SIDES}


def _foot_path(
    motion: Motion, body: Embodiment, side: str, contacts: NDArray[np.bool_]
) -> FootPath:
    heel = contacts[:, CONTACT_JOINTS.index(f"{side}_ankle")]
    toes = contacts[:, CONTACT_JOINTS.index(f"{side}_foot")]
    source = motion.global_rotations[:, CANONICAL.index(f"{side}_ankle")]
    flat = rot.about_axis(2, rot.twist_angle(source, axis=2))
    rotation = rot.slerp(source, flat, _soft(heel & toes, motion.fps))
    corners = rot.rotate(
        rotation[:, None], rot.rotate(body.turns[f"{side}_ankle"], body.soles[side])
    )
    planned = body.scale * motion.joint(f"{side}_ankle")[:, :2] + _widened(motion, body, side)
    ankle = np.empty((motion.frames, 3))
    ankle[:, :2] = planned + _correction(planned, corners[..., :2], heel, toes, body.scale)
    grip = _soft(heel | toes, motion.fps)
    ankle[:, 2] = _height(motion, body, side, corners[..., 2], grip)
    return FootPath(ankle, rotation, grip)


def _height(motion: Motion, body: Embodiment, side: str, corners: Array, grip: Array) -> Array:
    """Return the ankle's height at which heel and toes are as high as the skeleton's [T], m.

    The toes of the skeleton bend, the robot's do not: its toes are where the ball of the foot is.

    Args:
        motion: To follow.
        body: Of the robot.
        side: Of the foot.
        corners: Heights of the sole's corners above the ankle, rear ones first [T, 4], m.
        grip: Of `FootPath` [T].
    """
    heel = sole_probes(side).centres(motion)[:, :2, 2].min(axis=1)
    ball = motion.joint(f"{side}_foot")[:, 2] - TOE_HEIGHT
    wanted = body.scale * np.maximum(np.stack([heel, ball], axis=1), 0.0) * (1.0 - grip[:, None])
    lowest = corners.reshape(-1, 2, 2).min(axis=2)
    return np.max(wanted - lowest, axis=1)


def _cleaned(contacts: NDArray[np.bool_], fps: float) -> NDArray[np.bool_]:
    """Drop what lasts less than `LEAST_STANCE` [T, 4]."""
    frames = round(LEAST_STANCE * fps)
    if frames < 2 or len(contacts) < frames:
        return contacts
    window = np.ones((frames, 1), dtype=bool)
    padded = np.pad(contacts, ((frames, frames), (0, 0)), mode="edge")
    kept = binary_opening(binary_closing(padded, window), window)
    return kept[frames:-frames].astype(bool)


def _soft(flags: NDArray[np.bool_], fps: float) -> Array:
    return gaussian_filter1d(flags.astype(float), _SMOOTHING * fps, mode="nearest")


def _widened(motion: Motion, body: Embodiment, side: str) -> Array:
    """Return how far to the side the robot's wider hips put a foot [T, 2], m."""
    hips = motion.joint("left_hip") - motion.joint("right_hip")
    spare = body.half_hip_width - 0.5 * body.scale * float(np.linalg.norm(hips[0]))
    sign = 1.0 if side == "left" else -1.0
    return sign * max(spare, 0.0) * rot.unit(hips * [1.0, 1.0, 0.0])[:, :2]


def _correction(
    planned: Array, corners: Array, heel: NDArray[np.bool_], toes: NDArray[np.bool_], scale: float
) -> Array:
    """Return what to add to a planned path [T, 2] so that the foot does not slide in contact, m.

    Args:
        planned: [T, 2], m.
        corners: Of the sole, from the ankle, rear ones first [T, 4, 2], m.
        heel: Whether the heel bears [T].
        toes: Whether the toes bear [T].
        scale: Of the robot's legs.
    """
    bears = np.stack([heel, heel, toes, toes], axis=1)
    both = (bears[1:] & bears[:-1]).astype(float)
    holds = np.asarray(both.any(axis=1))
    weights = both / np.maximum(both.sum(axis=1, keepdims=True), 1.0)
    # the ankle goes back by as much as the bearing part of the sole would move
    roll = -np.einsum("tc,tcd->td", weights, np.diff(corners, axis=0))
    travelled = np.concatenate([np.zeros((1, 2)), np.cumsum(roll, axis=0)])
    known = np.zeros(len(planned), dtype=bool)
    out = np.zeros_like(planned)
    for first, last in runs(holds):
        frames = slice(first, last + 1)
        missing = travelled[frames] - planned[frames]
        out[frames] = missing - missing.mean(axis=0)
        known[frames] = True
    if not known.any():
        return out
    times = np.flatnonzero(known)
    if len(times) > 1:
        clamped = np.clip(np.arange(len(planned)), times[0], times[-1])
        out = PchipInterpolator(times, out[times])(clamped)
    size = np.linalg.norm(out, axis=1, keepdims=True)
    most = LONGEST_CORRECTION * scale
    return out * (most / np.maximum(size, most))
