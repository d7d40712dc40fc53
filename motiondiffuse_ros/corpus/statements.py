"""Captions from kinematics: what can be stated with certainty of a window, as people would say it.

Captions name the action and leave direction, side and speed to chance. Statements name just these,
so that left and right, forward and backward, walk and run are learnt from every clip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.corpus.travel import Travel
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS
from motiondiffuse_ros.motion.features import PoseState, Representation
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL

_LEFT = {
    "sideways": (
        "a person steps sideways to the left",
        "a person moves sideways to the left",
        "a person takes side steps to the left",
    ),
    "turn": ("a person turns to the left on the spot", "a person turns left"),
    "curve": ("a person walks in a curve to the left", "a person walks and turns left"),
    "run in a curve": ("a person runs in a curve to the left", "a person runs and turns left"),
    "one hand up": (
        "a person holds the left hand above the head",
        "a person raises the left hand above the head",
    ),
}
_NO_SIDE = {
    "walk": ("a person walks forward", "a person walks straight ahead"),
    "slow walk": ("a person walks forward slowly", "a person walks slowly"),
    "run": ("a person runs forward", "a person runs straight ahead"),
    "back": ("a person walks backward", "a person steps back"),
    "both hands up": (
        "a person holds both hands above the head",
        "a person raises both hands above the head",
    ),
    "bow": (
        "a person bends forward at the waist and straightens up again",
        "a person bows forward and comes up again",
    ),
    "still": ("a person stands still", "a person stays in place without moving"),
}

_UPRIGHT = np.cos(np.radians(35.0))
_TURN = np.radians(50.0)
_ON_THE_SPOT = 0.8  # m
_CURVE = 1.5  # m
_STILL = 0.06  # m/s, mean over all joints
_MOVING, _SLOW, _BRISK, _RUN = 0.2, 0.65, 0.8, 2.3  # m/s
_HELD = 0.4  # share of the window
_BENT, _ERECT = np.radians(40.0), np.radians(20.0)
_SUNK, _REACHING = 0.12, 0.45  # m


@dataclass(frozen=True)
class Statement:
    """Something that is certain of a window.

    Attributes:
        kind: What it is about, without its side.
        texts: Sentences that say it, each as good as the other.
    """

    kind: str
    texts: tuple[str, ...]


def _to_the_right(text: str) -> str:
    return text.replace("left", "right")


def state(features: Array, representation: Representation, fps: float) -> tuple[Statement, ...]:
    """Return all that is certain of a window; often nothing.

    Args:
        features: Of the window [T, D], not normalised.
        representation: What they mean; nothing is stated of other than the pose state.
        fps: Their rate, Hz.
    """
    if representation.name != PoseState.name:
        return ()
    kinds: list[tuple[str, int]] = []
    groups = representation.groups()
    root = features[:, groups["rotations"]][:, :6].reshape(-1, 2, 3)
    height = features[:, groups["root_height"]][:, 0]
    positions = features[:, groups["positions"]].reshape(len(features), -1, 3)
    way = Travel.of(features, representation, fps)
    if way.path < _ON_THE_SPOT and _bows(positions, height):
        kinds.append(("bow", 0))
    if root[:, 1, 1].min() > _UPRIGHT:
        feet = features[:, groups["contacts"]] > 0.5
        kinds += _travelling(way, _walks(feet))
        kinds += _hands(positions)
        velocities = features[:, groups["velocities"]].reshape(len(features), -1, 3)
        if np.linalg.norm(velocities, axis=-1).mean(axis=1).max() < _STILL:
            kinds.append(("still", 0))
    return tuple(Statement(kind, _texts(kind, side)) for kind, side in kinds)


def all_statements() -> tuple[str, ...]:
    """Return every sentence that `state` may give."""
    return tuple(
        text
        for kind in (*_LEFT, *_NO_SIDE)
        for side in ((1, -1) if kind in _LEFT else (0,))
        for text in _texts(kind, side)
    )


def _texts(kind: str, side: int) -> tuple[str, ...]:
    if kind in _NO_SIDE:
        return _NO_SIDE[kind]
    return _LEFT[kind] if side > 0 else tuple(map(_to_the_right, _LEFT[kind]))


def _travelling(way: Travel, walks: bool) -> list[tuple[str, int]]:
    if not walks:
        return []  # falls, slides and rides go somewhere too
    moving = way.speed > _MOVING
    if abs(way.turned) > _TURN:
        side = int(np.sign(way.turned))
        if way.path < _ON_THE_SPOT:
            return [("turn", side)]
        if way.ahead > max(_CURVE, 0.8 * way.path):
            return [("run in a curve" if way.speed > _RUN else "curve", side)]
        return []
    if way.side and moving:
        return [("sideways", way.side)]
    if way.straight < 0 and way.path > 0.5 and moving:
        return [("back", 0)]
    if way.straight > 0 and way.path > 0.8 and moving and abs(way.turned) < 0.5 * _TURN:
        if way.speed > _RUN:
            return [("run", 0)]
        if way.speed < _SLOW:
            return [("slow walk", 0)]
        if _BRISK < way.speed < 0.8 * _RUN:
            return [("walk", 0)]
    return []


def _walks(contacts: NDArray[np.bool_]) -> bool:
    """Whether each foot leaves the floor and stands on it, and one of them most of the time."""
    half = len(CONTACT_JOINTS) // 2
    feet = np.stack([contacts[:, :half].any(axis=1), contacts[:, half:].any(axis=1)], axis=1)
    steps = np.abs(np.diff(feet.astype(int), axis=0)).sum(axis=0)
    return bool((steps >= 2).all() and feet.any(axis=1).mean() > 0.3)


def _bows(positions: Array, height: Array) -> bool:
    """Whether the upper body bends far ahead between erect ends, over legs that stay long.

    A hand that reaches low picks something up; that is no bow.
    """
    neck = positions[:, CANONICAL.index("neck") - 1]
    pitch = np.arctan2(neck[:, 2], neck[:, 1] - height)
    erect = max(pitch[0], pitch[-1]) < _ERECT
    legs = height.max() - height.min() < _SUNK
    wrists = [positions[:, CANONICAL.index(f"{side}_wrist") - 1, 1] for side in ("left", "right")]
    return bool(erect and legs and pitch.max() > _BENT and np.min(wrists) > _REACHING)


def _hands(positions: Array) -> list[tuple[str, int]]:
    def height(name: str) -> Array:
        return positions[:, CANONICAL.index(name) - 1, 1]

    up = {side: height(f"{side}_wrist") > height("head") for side in ("left", "right")}
    down = {side: (height(f"{side}_wrist") < height(f"{side}_shoulder")).all() for side in up}
    if (up["left"] & up["right"]).mean() > _HELD:
        return [("both hands up", 0)]
    if up["left"].mean() > _HELD and down["right"]:
        return [("one hand up", 1)]
    if up["right"].mean() > _HELD and down["left"]:
        return [("one hand up", -1)]
    return []
