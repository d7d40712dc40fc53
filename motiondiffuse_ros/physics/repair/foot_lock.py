"""Feet that stand stay where they are: where each foot has to be, and legs that bring it there.

As in Kovar et al. 2002 ("Footskate cleanup for motion capture editing"): find when a foot stands,
hold what touches the floor in place, spread the correction smoothly over the steps in between, and
solve the legs analytically. Feet that move are lifted to where they do not graze the floor.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.motion.spans import runs
from motiondiffuse_ros.physics.geometry import sole_probes
from motiondiffuse_ros.physics.repair.contacts import ContactRule, foot_contacts
from motiondiffuse_ros.physics.repair.swing import smooth_cover, swing_lift
from motiondiffuse_ros.physics.repair.two_bones import reach_ankle

_RULE = ContactRule()
_FLAT = np.radians(20.0)  # a standing sole less steep than this lies on the floor
_TOUCHING = 0.008  # corners this near to the lowest one touch the floor with it [m]
_EASE = 0.2  # s, over which a sole comes to lie and leaves again
_FOLLOW = 0.3  # s, over which the root follows its feet
_COME_DOWN = 0.1  # s, over which the root comes down for a leg that is too short
_RUN_OUT = 0.2  # s, over which the speed of a correction dies away where a contact ends
_STRETCH = 0.9995  # of its length, up to which a leg may be stretched
_DEEPEST = 0.1  # m, by which the root comes down at most
_UP, _AHEAD, _LEFTWARDS = np.array([0.0, 0, 1]), np.array([1.0, 0, 0]), np.array([0.0, 1, 0])


@dataclass(frozen=True, eq=False)
class Foot:
    """One foot over time, as it is to be.

    Attributes:
        sole: World rotation of the foot [T, 4].
        toes: World rotation of the toes [T, 4].
        corners: Corners of the sole relative to the ankle [T, C, 3], m.
        ankle: Place of the ankle [T, 3], m, but for the lift.
        lift: How far the ankle is above that for the sole to clear the floor [T], m.
        contact: Whether it stands [T].
    """

    sole: Array = field(repr=False)
    toes: Array = field(repr=False)
    corners: Array = field(repr=False)
    ankle: Array = field(repr=False)
    lift: Array = field(repr=False)
    contact: NDArray[np.bool_] = field(repr=False)


def lock_feet(motion: Motion, rule: ContactRule = _RULE) -> Motion:
    """Hold standing feet in place, on the floor at z = 0.

    Args:
        motion: Two frames or more, on the floor as a whole.
        rule: When a foot stands.
    """
    corners = np.stack([sole_probes(side).centres(motion) for side in SIDES], axis=1)
    contacts = foot_contacts(corners, motion.fps, rule)
    feet = [_placed_foot(motion, side, contacts[:, n]) for n, side in enumerate(SIDES)]
    motion = motion.with_root(motion.root + _root_shift(motion, feet))
    rotations = motion.global_rotations.copy()
    for side, foot in zip(SIDES, feet, strict=True):
        _pose_leg(motion, rotations, side, foot)
    return replace(motion, rotations=CANONICAL.local_rotations(rotations))


def _placed_foot(motion: Motion, side: str, contact: NDArray[np.bool_]) -> Foot:
    heel, ball = CANONICAL.index(f"{side}_ankle"), CANONICAL.index(f"{side}_foot")
    sole, toes = _laid_down(motion, heel, ball, contact)
    probes = sole_probes(side)
    of_heel = np.array(probes.joints) == heel
    corners = np.where(
        of_heel[:, None],
        rot.rotate(sole[:, None], probes.offsets),
        rot.rotate(sole, CANONICAL.offsets[ball])[:, None]
        + rot.rotate(toes[:, None], probes.offsets),
    )
    ankle = motion.positions[:, heel].copy()
    lowest = corners[..., 2].min(axis=1)
    ankle[:, :2] += _bridged(_held(ankle, corners, contact), contact, motion.fps)
    ankle[:, 2] += _bridged(-(ankle[:, 2] + lowest)[:, None], contact, motion.fps)[:, 0]
    # whatever the path between contacts is, it does not lead through the floor
    ankle[:, 2] = np.maximum(ankle[:, 2], -lowest)
    lift = swing_lift(ankle[:, None] + corners, contact, motion.fps)
    return Foot(sole, toes, corners, ankle, lift, contact)


def _laid_down(
    motion: Motion, heel: int, ball: int, contact: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """Return the rotations of foot and toes, level where the sole stands and is nearly level."""
    sole, toes = motion.global_rotations[:, heel], motion.global_rotations[:, ball]
    steep = np.arccos(np.clip(rot.rotate(sole, _UP)[:, 2], -1.0, 1.0))
    flat = contact & (steep < _FLAT)
    sole, toes = sole.copy(), toes.copy()
    for joint, standing in ((sole, flat), (toes, contact)):
        for start, stop in runs(standing):
            joint[start:stop] = _level(joint[start:stop], motion.fps)
    return sole, toes


def _level(rotations: Array, fps: float) -> Array:
    """Return rotations of one contact levelled, with one heading, eased in and out."""
    ahead = rot.rotate(rotations, _AHEAD)[:, :2].mean(axis=0)
    flat = rot.about_axis(2, np.arctan2(ahead[1], ahead[0]))
    frames = np.arange(len(rotations))
    from_edge = np.minimum(frames, frames[::-1]) + 1.0
    weight = np.clip(from_edge / (_EASE * fps + 1.0), 0.0, 1.0)
    return rot.slerp(rotations, np.broadcast_to(flat, rotations.shape), weight)


def _held(ankle: Array, corners: Array, contact: NDArray[np.bool_]) -> Array:
    """Return the horizontal corrections [T, 2] that undo the slide within each contact."""
    out = np.zeros((len(ankle), 2))
    world = ankle[:, None, :2] + corners[..., :2]
    heights = corners[..., 2] - corners[..., 2].min(axis=1, keepdims=True)
    for start, stop in runs(contact):
        touching = heights[start:stop] < _TOUCHING
        both = touching[1:] & touching[:-1]
        # where the sole rolls from one edge to the other at once, its lowest corner holds on
        both |= ~both.any(axis=1, keepdims=True) & touching[1:]
        step = np.diff(world[start:stop], axis=0) * both[..., None]
        slide = step.sum(axis=1) / both.sum(axis=1)[:, None]
        drift = np.concatenate([np.zeros((1, 2)), -np.cumsum(slide, axis=0)])
        out[start:stop] = drift - drift.mean(axis=0)
    return out


def _bridged(values: Array, contact: NDArray[np.bool_], fps: float) -> Array:
    """Keep values [T, k] within contacts and lead smoothly from one to the next."""
    out = values.copy()
    spans = runs(contact)
    if not spans:
        return np.zeros_like(values)
    out[: spans[0][0]] = values[spans[0][0]]
    out[spans[-1][1] :] = values[spans[-1][1] - 1]
    for (_, start), (stop, _) in pairwise(spans):
        share = (np.arange(start, stop) - start + 1.0) / (stop - start + 1.0)
        # the quintic that starts and ends without velocity and acceleration
        eased = (share**3 * (10.0 - 15.0 * share + 6.0 * share**2))[:, None]
        out[start:stop] = values[start - 1] * (1.0 - eased) + values[stop] * eased
    longest = round(_RUN_OUT * fps)
    edges = [(0, 0), *spans, (len(out), len(out))]
    for (_, before), (start, stop), (after, _) in zip(edges, spans, edges[2:], strict=False):
        if stop - start > 1:
            later = _run_out(values[stop - 1] - values[stop - 2], min(after - stop, longest))
            out[stop : stop + len(later)] += later
            earlier = _run_out(values[start] - values[start + 1], min(start - before, longest))
            out[start - len(earlier) : start] += earlier[::-1]
    return out


def _run_out(step: Array, frames: int) -> Array:
    """Return what a correction that changes by a step [k] adds after it ends [frames, k]."""
    frame = np.arange(1.0, frames + 1.0)
    return (frame * (1.0 - frame / (frames + 1.0)) ** 3)[:, None] * step


def _root_shift(motion: Motion, feet: list[Foot]) -> Array:
    """Return how far the root follows its feet [T, 3], m.

    It takes the mean of their corrections, smoothed, so that its own momentum stays, and comes
    down where a leg would have to be longer than it is.
    """
    names = [CANONICAL.index(f"{side}_ankle") for side in SIDES]
    moved = np.stack([f.ankle for f in feet], 1) - motion.positions[:, names]
    shift = gaussian_filter1d(moved.mean(axis=1), _FOLLOW * motion.fps, axis=0, mode="nearest")
    lower = np.zeros(motion.frames)
    for side, foot in zip(SIDES, feet, strict=True):
        hip = motion.joint(f"{side}_hip") + shift
        bones = [CANONICAL.index(f"{side}_{joint}") for joint in ("knee", "ankle")]
        whole = _STRETCH * float(np.linalg.norm(CANONICAL.offsets[bones], axis=-1).sum())
        apart = np.linalg.norm((foot.ankle - hip)[:, :2], axis=-1)
        highest = foot.ankle[:, 2] + np.sqrt(np.maximum(whole**2 - apart**2, 0.0))
        lower = np.maximum(lower, np.where(foot.contact, hip[:, 2] - highest, 0.0))
    width = max(round(_COME_DOWN * motion.fps), 1)
    shift[:, 2] -= smooth_cover(np.minimum(lower, _DEEPEST), width)
    return shift


def _pose_leg(motion: Motion, rotations: Array, side: str, foot: Foot) -> None:
    """Write a leg that carries its foot into world rotations [T, J, 4], in place."""
    names = [f"{side}_{part}" for part in ("hip", "knee", "ankle", "foot")]
    hip, knee, heel, ball = (CANONICAL.index(name) for name in names)
    thigh, shank = rotations[:, hip], rotations[:, knee]
    places = motion.positions
    rotations[:, hip], rotations[:, knee] = reach_ankle(
        places[:, hip],
        places[:, knee],
        places[:, heel],
        foot.ankle + foot.lift[:, None] * _UP,
        thigh,
        shank,
        rot.rotate(thigh, _LEFTWARDS),
    )
    rotations[:, heel], rotations[:, ball] = foot.sole, foot.toes
