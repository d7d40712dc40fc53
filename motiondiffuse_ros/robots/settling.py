"""An ending in which the body comes to stand: it finishes its step and straightens up.

A foot that stands stays where it stands and comes to lie flat. One in the air steps to where it
catches the body. The pelvis goes over the middle of both and upright, trunk and arms into the
upright stance; the speeds of the motion die away on the way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS, detect_contacts
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import (
    ANKLE_HEIGHT,
    HEEL_BEHIND_ANKLE,
    LEG_LENGTH,
    SIDES,
    STANDING_HEIGHT,
)
from motiondiffuse_ros.physics.humanoid import rest_angles
from motiondiffuse_ros.physics.repair.two_bones import reach_ankle
from motiondiffuse_ros.physics.state import qpos_to_motion

SECONDS = 1.2
"""Until the stance is reached [s]."""

HOLD = 0.3
"""For which it is held then, while the trajectory slows to rest [s]."""

_STEP = 0.6  # until a foot in the air has landed, and one on the floor lies flat [s]
_OVERSHOOT = 0.25  # that the speed of pelvis or foot adds on the way at most [m]
_SPEEDS_DIE = 0.4  # until the speeds of the joints have died away [s]
_CATCH = 0.45  # a foot lands where the body would be after this time [s]
_LONGEST_STEP = 0.7  # from one foot to the other along the heading [m]
_NARROWEST, _WIDEST = 0.16, 0.36  # from one foot to the other across it [m]
_LIFT, _LIFTED_STEP = 0.05, 0.3  # by which a foot is raised, on a step of this length or more [m]
_MOST_TURN = 0.6  # of the pelvis from a foot that stands [rad]
_STRETCH = 0.985  # of its length, up to which a leg is stretched
_KNEE = 0.3  # of the pose that legs are solved from [rad]
_EASE = 0.2  # over which pelvis and legs come to what the feet ask for [s]
_LOWEST, _STEEPEST = 0.5, np.radians(60.0)  # pelvis of a body that can come to stand [m]
_FARTHEST = 0.192  # reached by `_dying`, in parts of its time
_FASTEST = 40.0  # rad/s; faster is a rotation vector that changed its sign
_OVER_SOLE = 0.04  # of the pelvis ahead of the ankles [m]
_HALF_WIDTH = float(CANONICAL.offsets[CANONICAL.index("left_hip"), 1])
_HEEL = np.array([-HEEL_BEHIND_ANKLE, 0.0, -ANKLE_HEIGHT])
_TIP = np.array([0.18, 0.0, -ANKLE_HEIGHT])
_BALL = CANONICAL.offsets[CANONICAL.index("left_foot")]
_UP, _AHEAD, _LEFTWARDS = np.eye(3)[[2, 0, 1]]


@dataclass(frozen=True, eq=False)
class _Foot:
    """One foot over the ending.

    Attributes:
        ankle: Place [T, 3], m.
        rotation: In the world [T, 4].
        toes: Rotation of the toes in the world [T, 4].
        stands: Whether it bears [T].
    """

    ankle: Array = field(repr=False)
    rotation: Array = field(repr=False)
    toes: Array = field(repr=False)
    stands: NDArray[np.bool_] = field(repr=False)


def can_settle(motion: Motion) -> bool:
    """Whether the body is upright enough at its end to come to stand from there."""
    up = rot.rotate(motion.rotations[-1, 0], _UP)[2]
    return motion.frames > 1 and bool(motion.root[-1, 2] > _LOWEST and up > np.cos(_STEEPEST))


def settled(motion: Motion) -> Motion:
    """Append an ending in which the body comes to stand on both feet, and stays.

    Args:
        motion: On a floor at z = 0; see `can_settle`.
    """
    fps = motion.fps
    frames = max(2, round(SECONDS * fps))
    times = np.minimum(np.arange(1, frames + max(1, round(HOLD * fps)) + 1), frames) / fps
    bearing = _bearing(motion)
    heading = _heading(motion, bearing)
    places = _places(motion, bearing, heading)
    feet = {
        side: _standing_foot(motion, side, bearing[side], times)
        if bearing[side] is not None
        else _stepping_foot(motion, side, places[side], heading, times)
        for side in SIDES
    }
    turn = rot.about_axis(2, np.array(heading))
    pelvis = np.mean(list(places.values()), axis=0) + _OVER_SOLE * rot.rotate(turn, _AHEAD)
    pelvis[2] = STANDING_HEIGHT
    ending = Motion(
        _moved(motion.root, pelvis, times, fps),
        _turned(
            motion.rotations,
            np.concatenate([turn[None], _upright()[1:]]),
            times,
            fps,
            # their feet give legs their speed; one of their own could bend a knee backwards
            still=[CANONICAL.index(f"{s}_{joint}") for s in SIDES for joint in ("hip", "knee")],
        ),
        fps,
    )
    ending = replace(ending, root=ending.root - _lowered(ending, feet)[:, None] * _UP)
    rotations = ending.global_rotations.copy()
    for side, foot in feet.items():
        _pose_leg(ending, rotations, side, foot)
    return replace(
        motion,
        root=np.concatenate([motion.root, ending.root]),
        rotations=np.concatenate([motion.rotations, CANONICAL.local_rotations(rotations)]),
    )


@cache
def _upright() -> Array:
    """Return the local rotations of the upright stance [J, 4], knees bent a little."""
    qpos = np.concatenate([[0.0, 0.0, STANDING_HEIGHT, 1.0, 0.0, 0.0, 0.0], rest_angles()])
    rotations = qpos_to_motion(qpos[None], 1.0).rotations[0]
    for side in SIDES:  # legs are solved for, and this tells which way knees bend
        for joint, share in (("hip", -0.5), ("knee", 1.0)):
            rotations[CANONICAL.index(f"{side}_{joint}")] = rot.about_axis(
                1, np.array(share * _KNEE)
            )
    return rotations


def _bearing(motion: Motion) -> dict[str, Array | None]:
    """Return the point of each foot that bears at the end, in the foot's frame; None in the air."""
    end = motion.slice(max(0, motion.frames - 3), motion.frames)
    bears: dict[str, bool] = dict(zip(CONTACT_JOINTS, detect_contacts(end)[-1], strict=True))
    return {
        side: _BALL if bears[f"{side}_foot"] else _HEEL if bears[f"{side}_ankle"] else None
        for side in SIDES
    }


def _last_foot(motion: Motion, side: str) -> tuple[Array, Array, float]:
    """Return the last place of an ankle, and rotation and heading [rad] of its foot."""
    ankle = CANONICAL.index(f"{side}_ankle")
    rotation = motion.global_rotations[-1, ankle]
    ahead = rot.rotate(rotation, _AHEAD)
    return motion.positions[-1, ankle], rotation, float(np.arctan2(ahead[1], ahead[0]))


def _heading(motion: Motion, bearing: dict[str, Array | None]) -> float:
    """Return where the body faces in the end: as it does, but not far from where its feet do."""
    heading = float(motion.heading[-1])
    for side in SIDES:
        if bearing[side] is not None:
            yaw = _last_foot(motion, side)[2]
            off = (heading - yaw + np.pi) % (2 * np.pi) - np.pi
            heading = yaw + float(np.clip(off, -_MOST_TURN, _MOST_TURN))
    return heading


def _places(motion: Motion, bearing: dict[str, Array | None], heading: float) -> dict[str, Array]:
    """Return where the ankles of the flat feet come to be, by side [3], m."""
    places: dict[str, Array] = {}
    for side in SIDES:
        if (pivot := bearing[side]) is not None:
            ankle, rotation, yaw = _last_foot(motion, side)
            flat = rot.rotate(rot.about_axis(2, np.array(yaw)), pivot)
            places[side] = (ankle + rot.rotate(rotation, pivot) - flat) * [1.0, 1.0, 0.0]
    turn = rot.about_axis(2, np.array(heading))
    caught = _CATCH * (motion.root[-1] - motion.root[-2]) * motion.fps
    caught *= min(1.0, _LONGEST_STEP / max(float(np.linalg.norm(caught[:2])), 1e-9))
    caught = (motion.root[-1] + caught) * [1.0, 1.0, 0.0]
    standing = next(iter(places.values()), None)
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        if bearing[side] is None:
            place = caught + sign * _HALF_WIDTH * rot.rotate(turn, _LEFTWARDS)
            if standing is not None:
                along, across, _ = rot.rotate(rot.conjugate(turn), place - standing)
                along = np.clip(along, -_LONGEST_STEP, _LONGEST_STEP)
                across = sign * np.clip(sign * across, _NARROWEST, _WIDEST)
                place = standing + rot.rotate(turn, np.array([along, across, 0.0]))
            places[side] = place
    return {side: places[side] + ANKLE_HEIGHT * _UP for side in SIDES}


def _standing_foot(motion: Motion, side: str, pivot: Array | None, times: Array) -> _Foot:
    """Let a foot come to lie flat about the point on which it bears."""
    assert pivot is not None
    ankle, rotation, yaw = _last_foot(motion, side)
    flat = rot.about_axis(2, np.array(yaw))
    share = 1.0 - _fading(times, _STEP)
    turned = rot.slerp(rotation, flat, share)
    place = ankle + rot.rotate(rotation, pivot)
    lying = place * [1.0, 1.0, 0.0] + (ANKLE_HEIGHT + pivot[2]) * _UP
    bearing = place + share[:, None] * (lying - place)
    toes = motion.global_rotations[-1, CANONICAL.index(f"{side}_foot")]
    return _Foot(
        bearing - rot.rotate(turned, pivot),
        turned,
        rot.slerp(toes, flat, share),
        np.ones(len(times), dtype=bool),
    )


def _stepping_foot(motion: Motion, side: str, place: Array, heading: float, times: Array) -> _Foot:
    """Let a foot step to a place."""
    ankle, toes = CANONICAL.index(f"{side}_ankle"), CANONICAL.index(f"{side}_foot")
    flat = rot.about_axis(2, np.array([heading, heading]))
    foot = motion.global_rotations[-2:, [ankle, toes]]
    turned = _turned(foot, flat, times, motion.fps, _STEP)
    path = _moved(motion.positions[:, ankle], place, times, motion.fps, _STEP)
    u = np.minimum(times / _STEP, 1.0)
    way = float(np.linalg.norm(place[:2] - motion.positions[-1, ankle, :2]))
    path[:, 2] += _LIFT * min(1.0, way / _LIFTED_STEP) * 64.0 * (u * (1.0 - u)) ** 3
    lowest = np.minimum(*(rot.rotate(turned[:, 0], edge)[:, 2] for edge in (_HEEL, _TIP)))
    path[:, 2] = np.maximum(path[:, 2], -lowest)
    return _Foot(path, turned[:, 0], turned[:, 1], u >= 1.0)


def _fading(times: Array, seconds: float) -> Array:
    """Return a quintic that falls from 1 to 0 in some seconds, at rest at both ends."""
    u = np.clip(times / seconds, 0.0, 1.0)
    return 1.0 - u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


def _dying(times: Array, seconds: float) -> Array:
    """Return what a speed of 1 that dies away in some seconds adds: 0 at both ends."""
    u = np.clip(times / seconds, 0.0, 1.0)
    return seconds * (u - 6.0 * u**3 + 8.0 * u**4 - 3.0 * u**5)


def _moved(path: Array, target: Array, times: Array, fps: float, seconds: float = SECONDS) -> Array:
    """Go on from the end of a path [N, 3] to a target in some seconds while its speed dies away."""
    speed = (path[-1] - path[-2]) * fps
    dying = min(seconds, _OVERSHOOT / max(_FARTHEST * float(np.linalg.norm(speed)), 1e-9))
    off = _fading(times, seconds)[:, None] * (path[-1] - target)
    return target + off + _dying(times, dying)[:, None] * speed


def _turned(
    rotations: Array,
    target: Array,
    times: Array,
    fps: float,
    seconds: float = SECONDS,
    still: Sequence[int] = (),
) -> Array:
    """Go on from rotations [N, J, 4] to a target [J, 4] while their speeds die away [T, J, 4].

    Those that are `still` have none.
    """
    back = rot.conjugate(target)
    before, last = (rot.to_rotation_vector(rot.multiply(back, r)) for r in rotations[-2:])
    speed = (last - before) * fps
    speed[np.linalg.norm(speed, axis=1) > _FASTEST] = 0.0
    speed[list(still)] = 0.0
    off = (
        _fading(times, seconds)[:, None, None] * last
        + _dying(times, _SPEEDS_DIE)[:, None, None] * speed
    )
    return rot.multiply(target, rot.from_rotation_vector(off))


def _lowered(ending: Motion, feet: dict[str, _Foot]) -> Array:
    """Return by how much the pelvis comes down for feet that stand to be in reach [T], m."""
    lower = np.zeros(ending.frames)
    for side, foot in feet.items():
        hip = ending.joint(f"{side}_hip")
        apart = np.linalg.norm((foot.ankle - hip)[:, :2], axis=1)
        reach = np.sqrt(np.maximum((_STRETCH * LEG_LENGTH) ** 2 - apart**2, 0.0))
        lower = np.maximum(lower, np.where(foot.stands, hip[:, 2] - foot.ankle[:, 2] - reach, 0.0))
    width = max(1, round(0.5 * _EASE * ending.fps))
    covered = maximum_filter1d(lower, 2 * width + 1, mode="nearest")
    return (1.0 - _fading(np.arange(1, ending.frames + 1) / ending.fps, _EASE)) * gaussian_filter1d(
        covered, 0.5 * width, mode="nearest"
    )


def _pose_leg(ending: Motion, rotations: Array, side: str, foot: _Foot) -> None:
    """Write a leg that carries its foot into world rotations [T, J, 4], in place."""
    names = [f"{side}_{part}" for part in ("hip", "knee", "ankle", "foot")]
    hip, knee, ankle, toes = (CANONICAL.index(name) for name in names)
    places, thigh = ending.positions, rotations[:, hip]
    rotations[:, hip], rotations[:, knee] = reach_ankle(
        places[:, hip],
        places[:, knee],
        places[:, ankle],
        foot.ankle,
        thigh,
        rotations[:, knee],
        rot.rotate(thigh, _LEFTWARDS),
    )
    rotations[:, ankle], rotations[:, toes] = foot.rotation, foot.toes
