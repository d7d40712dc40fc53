"""What the kinematics of a window leave no doubt about; `statements` puts it into words.

Rules are strict: a window of which nothing is certain is better left unsaid. A window and its
mirror image give the same findings with their sides swapped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.corpus.travel import Travel
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL, TOE_HEIGHT
from motiondiffuse_ros.motion.spans import runs

_UPRIGHT = np.cos(np.radians(35.0))
_TURN, _HALF_TURN = np.radians(50.0), np.radians((140.0, 230.0))
_QUARTER_TURN, _CIRCLE = np.radians((70.0, 115.0)), np.radians(270.0)
_ON_THE_SPOT = 0.8  # m
_CURVE = 1.5  # m
_STILL = 0.06  # m/s, mean over all joints
_MOVING, _SLOW, _BRISK, _RUN = 0.2, 0.65, 0.8, 2.3  # m/s
_FAST_WALK, _SLOW_RUN, _FAST_RUN = (1.6, 2.1), 2.8, 3.1  # m/s
_HELD = 0.4  # share of the window
_BENT, _ERECT = np.radians(40.0), np.radians(20.0)
_SUNK, _DOWN, _REACHING = 0.12, 0.3, 0.45  # m
_SPREAD, _GRIP = 1.1, 0.3  # m between the wrists
_LEG_UP, _FOOT_DOWN = 0.35, 0.15  # m, toe over the floor
_QUICK, _CALM = 2.2, 1.0  # m/s, against the body
_SWING, _WAVES = 0.06, 3  # m to and fro, times
_OFF_THE_FLOOR = 0.06  # m
_FREE_FALL, _FLIGHT = -5.0, 0.12  # m/s², s
_STEPS = 4
_STEP_LENGTH, _STANDING = (0.25, 0.9), 0.9  # m, share of the window
_KNEELING, _KNEELING_UPRIGHT = 0.2, np.cos(np.radians(50.0))  # m, knee over the floor
_FULL_TURN = np.radians((300.0, 430.0))
_LEAP, _KNEE_UP, _LEG_STRAIGHT = 0.4, 0.2, 0.3  # m ahead, m of a knee below its hip
_LIFTS = 0.4  # times a second, of each knee
_HEEL_UP, _TIPTOEING = 0.1, 0.6  # m over the toes, share of the window
_CLAP, _PARTING, _CLAPS = 0.2, 0.12, 3  # m between the wrists, m further between claps, times
_LEGS, _JACKS = (0.35, 0.5), 0.45  # m between the ankles: together, apart; times a second
_SEAT, _SEAT_BEHIND, _SITTING = (0.3, 0.75), 0.15, 0.7  # m, m behind the heels, s

FEW_STEPS = range(2, 6)
"""Numbers of steps that are counted."""


@dataclass(frozen=True)
class Finding:
    """One thing that is certain.

    Attributes:
        kind: What it is about.
        side: 1 is left, -1 right, 0 neither.
        metres: Distance gone, 0 where it is about something else.
        steps: Steps taken, 0 where it is about something else.
    """

    kind: str
    side: int = 0
    metres: int = 0
    steps: int = 0


def findings(features: Array, representation: Representation, fps: float) -> list[Finding]:
    """Return all that is certain of a window of the pose state.

    Args:
        features: Of the window [T, D], not normalised.
        representation: The pose state.
        fps: Their rate, Hz.
    """
    groups = representation.groups()
    body = _Body(features, representation)
    way = Travel.of(features, representation, fps)
    found: list[Finding] = []
    if way.path < _ON_THE_SPOT:
        found += _postures(body, way, fps)
        if body.upright.min() > _UPRIGHT and _claps(body):
            found.append(Finding("claps"))
    if way.speed < _SLOW:
        found += _legs(body, fps)
    if way.speed < 0.8 * _RUN:
        found += _jumps(body, way, fps)
    if body.upright.min() > _UPRIGHT:
        feet = features[:, groups["contacts"]] > 0.5
        found += _travelling(way, _walks(feet), feet)
        if _marches(body, fps):
            if Finding("on the spot") in found:
                found.append(Finding("march"))
            elif way.straight > 0 and _MOVING < way.speed < 0.8 * _RUN:
                found.append(Finding("march ahead"))
        if way.straight > 0 and _MOVING < way.speed < _BRISK and _tiptoes(body):
            found.append(Finding("tiptoe"))
        found += _hands(body, fps)
        velocities = features[:, groups["velocities"]].reshape(len(features), -1, 3)
        if np.linalg.norm(velocities, axis=-1).mean(axis=1).max() < _STILL:
            found.append(Finding("still"))
    return found


class _Body:
    """Places of joints in the heading frame: x left, y up, z ahead, x and z from the root."""

    def __init__(self, features: Array, representation: Representation) -> None:
        groups = representation.groups()
        self.height = features[:, groups["root_height"]][:, 0]
        columns = features[:, groups["rotations"]][:, :6].reshape(-1, 2, 3)
        self.upright = columns[:, 1, 1]
        self._positions = features[:, groups["positions"]].reshape(len(features), -1, 3)

    def place(self, name: str) -> Array:
        """Return [T, 3] of a joint below the root."""
        return self._positions[:, CANONICAL.index(name) - 1]

    def level(self, name: str) -> Array:
        """Return the height of a joint over the floor [T]."""
        return self.place(name)[:, 1]

    def speed(self, name: str, fps: float) -> Array:
        """Return the speed of a joint against the root [T - 2], smoothed over three frames."""
        place = self.place(name) - np.stack([0 * self.height, self.height, 0 * self.height], -1)
        return np.linalg.norm(place[2:] - place[:-2], axis=-1) * fps / 2.0


def _travelling(way: Travel, walks: bool, feet: NDArray[np.bool_]) -> list[Finding]:
    if not walks:
        return []  # falls, slides and rides go somewhere too
    moving = way.speed > _MOVING
    size, side = abs(way.turned), int(np.sign(way.turned))
    if size > _TURN:
        return _turning(way, size, side)
    if way.path < _ON_THE_SPOT and size < 0.5 * _TURN and _step_count(feet) >= _STEPS:
        return [Finding("on the spot")]
    if way.side and moving:
        return [Finding("sideways", way.side)]
    if way.straight < 0 and way.path > 0.5 and moving:
        slow = [Finding("slow back")] if way.speed < _SLOW else []
        return [Finding("back"), *slow, *_counted(way, feet, "steps back")]
    if way.straight > 0 and way.path > 0.8 and moving and size < 0.5 * _TURN:
        return [*_straight_ahead(way), *_counted(way, feet, "steps")]
    return []


def _counted(way: Travel, feet: NDArray[np.bool_], kind: str) -> list[Finding]:
    """Return how many steps a way took, if they are few and one foot stands nearly always."""
    steps = int((_changes(feet) > 0).sum())
    long = _STEP_LENGTH[0] * steps < way.path < _STEP_LENGTH[1] * steps
    sure = steps in FEW_STEPS and long and _feet(feet).any(axis=1).mean() > _STANDING
    return [Finding(kind, steps=steps)] if sure else []


def _turning(way: Travel, size: float, side: int) -> list[Finding]:
    found = []
    if way.path < _ON_THE_SPOT:
        found.append(Finding("turn", side))
    elif way.ahead > max(_CURVE, 0.8 * way.path):
        if size > _CIRCLE:
            found += [Finding("circle", side), Finding("in circles")]
        found.append(Finding("run in a curve" if way.speed > _RUN else "curve", side))
    if way.path < 2.0 * _ON_THE_SPOT:
        if _QUARTER_TURN[0] < size < _QUARTER_TURN[1]:
            found.append(Finding("quarter turn", side))
        elif _HALF_TURN[0] < size < _HALF_TURN[1]:
            found.append(Finding("half turn", side))
        elif _FULL_TURN[0] < size < _FULL_TURN[1]:
            found.append(Finding("full turn", side))
    return found


def _straight_ahead(way: Travel) -> list[Finding]:
    found = []
    if way.speed > _RUN:
        found.append(Finding("run"))
        if way.speed < _SLOW_RUN:
            found.append(Finding("slow run"))
        elif way.speed > _FAST_RUN:
            found.append(Finding("fast run"))
        return found
    if way.speed < _SLOW:
        found.append(Finding("slow walk"))
    elif _BRISK < way.speed < 0.8 * _RUN:
        found.append(Finding("walk"))
    if _FAST_WALK[0] < way.speed < _FAST_WALK[1]:
        found.append(Finding("fast walk"))
    metres = round(way.ahead)
    if way.speed < _FAST_WALK[0] and abs(way.ahead - metres) < 0.2:
        found.append(Finding("distance", metres=max(metres, 1)))
    return found


def _walks(contacts: NDArray[np.bool_]) -> bool:
    """Whether each foot leaves the floor and stands on it, and one of them most of the time."""
    steps = np.abs(_changes(contacts)).sum(axis=0)
    return bool((steps >= 2).all() and _feet(contacts).any(axis=1).mean() > 0.3)


def _step_count(contacts: NDArray[np.bool_]) -> int:
    """Return how often a foot is lifted."""
    return int((_changes(contacts) < 0).sum())


def _changes(contacts: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Return where each foot is put down (1) and lifted (-1) [T - 1, 2]."""
    return np.diff(_feet(contacts).astype(int), axis=0)


def _feet(contacts: NDArray[np.bool_]) -> NDArray[np.bool_]:
    half = len(CONTACT_JOINTS) // 2
    return np.stack([contacts[:, :half].any(axis=1), contacts[:, half:].any(axis=1)], axis=1)


def _postures(body: _Body, way: Travel, fps: float) -> list[Finding]:
    """Return what the body does with its height: bows, goes down, reaches down."""
    neck = body.place("neck")
    pitch = np.arctan2(neck[:, 2], neck[:, 1] - body.height)
    erect = max(pitch[0], pitch[-1]) < _ERECT
    lowest = np.minimum(body.level("left_wrist"), body.level("right_wrist")).min()
    legs = body.height.max() - body.height.min()
    found = []
    # a hand that reaches low picks something up; that is no bow
    if erect and legs < _SUNK and pitch.max() > _BENT and lowest > _REACHING:
        found.append(Finding("bow"))
    from_standing = pitch[0] < _ERECT and body.height[0] > body.height.max() - _SUNK
    if from_standing and legs > _DOWN:
        found += _down(body, way, fps)
    if from_standing and lowest < _REACHING - 0.1:
        found.append(Finding("reach down"))
    return found


def _down(body: _Body, way: Travel, fps: float) -> list[Finding]:
    """Return how a body goes down that stood at first: on the knees, to a seat or over its feet."""
    knees = np.minimum(body.level("left_knee"), body.level("right_knee"))
    if knees.min() < _KNEELING:
        kneels = (knees < _KNEELING) & (body.upright > _KNEELING_UPRIGHT)
        turns = abs(way.turned) > _TURN  # spins and falls pass over the knees
        return [Finding("on the knees")] if kneels.mean() > 0.05 and not turns else []
    if _sits(body, fps):
        return [Finding("sit down")]
    toes = np.maximum(body.level("left_foot"), body.level("right_foot"))
    return [Finding("down low")] if toes.max() < _FOOT_DOWN else []


def _sits(body: _Body, fps: float) -> bool:
    """Whether the pelvis comes to rest low and behind both heels: only a seat can hold it there."""
    ahead = np.minimum(body.place("left_ankle")[:, 2], body.place("right_ankle")[:, 2])
    seated = (body.height > _SEAT[0]) & (body.height < _SEAT[1]) & (ahead > _SEAT_BEHIND)
    return sum(stop - start for start, stop in runs(seated)) > _SITTING * fps


def _legs(body: _Body, fps: float) -> list[Finding]:
    toes = {side: body.level(f"{side}_foot") for side in ("left", "right")}
    found = []
    for side, own, other in ((1, "left", "right"), (-1, "right", "left")):
        up = toes[own] > _LEG_UP
        if not up.any() or toes[other].max() > _FOOT_DOWN:
            continue
        fast = body.speed(f"{own}_foot", fps).max(initial=0.0)
        if fast > 2.0 * _QUICK:
            found.append(Finding("one leg fast", side))
        elif up.mean() > 0.5 * _HELD:
            found.append(Finding("one leg up", side))
    return found


def _jumps(body: _Body, way: Travel, fps: float) -> list[Finding]:
    """Find flights: both feet off the floor while the root falls freely, up or down."""
    toes = {side: body.level(f"{side}_foot") for side in ("left", "right")}
    low = np.minimum(toes["left"], toes["right"])[1:-1]
    falling = np.diff(body.height, 2) * fps**2 < _FREE_FALL
    flying = (low > TOE_HEIGHT + _OFF_THE_FLOOR) & falling
    times = sum(stop - start >= _FLIGHT * fps for start, stop in runs(flying))
    if not times:
        return []
    for side, own, other in ((1, "left", "right"), (-1, "right", "left")):
        if toes[other].min() > TOE_HEIGHT + _OFF_THE_FLOOR and toes[own].min() < _FOOT_DOWN:
            upright = body.upright.min() > _UPRIGHT
            return [Finding("hops", side)] if upright and times > 1 else []
    found = [Finding("jump")]
    if times > 1 and way.path < 2.0 * _ON_THE_SPOT and _jumping_jacks(body, fps):
        found.append(Finding("jumping jacks"))
    if times > 2:
        found.append(Finding("jumps"))
    if way.straight > 0 and way.ahead > _LEAP * times:
        found.append(Finding("jump ahead"))
    return found


def _jumping_jacks(body: _Body, fps: float) -> bool:
    """Whether arms go up while legs go apart, and down while they come together, all the time."""
    sides = ("left", "right")
    wrists = [body.level(f"{side}_wrist") for side in sides]
    up = np.min(wrists, axis=0) > body.level("head")
    down = np.max(wrists, axis=0) < body.level("left_shoulder")
    apart = np.linalg.norm(body.place("left_ankle") - body.place("right_ankle"), axis=-1)
    opened = sum(apart[start:stop].max() > _LEGS[1] for start, stop in runs(up))
    closed = sum(apart[start:stop].min() < _LEGS[0] for start, stop in runs(down))
    return min(opened, closed) >= max(2, _JACKS * len(up) / fps)


def _claps(body: _Body) -> bool:
    """Whether the hands meet in front of the chest and part, again and again."""
    left, right = body.place("left_wrist"), body.place("right_wrist")
    apart = np.linalg.norm(left - right, axis=-1)
    low, high = body.height + 0.1, body.level("head")
    chest = np.all([(w[:, 1] > low) & (w[:, 1] < high) for w in (left, right)], axis=0)
    meet = _peaks(-apart, height=-_CLAP, prominence=_PARTING)
    level = np.abs(left[:, 1] - right[:, 1]) < _CLAP
    return int((chest & level)[meet].sum()) >= _CLAPS


def _marches(body: _Body, fps: float) -> bool:
    """Whether both knees come up nearly to the hips by turns, all the time."""
    below = [body.level(f"{side}_hip") - body.level(f"{side}_knee") for side in ("left", "right")]
    lifts = [
        len(runs((own < _KNEE_UP) & (other > _LEG_STRAIGHT)))
        for own, other in (below, reversed(below))
    ]
    return min(lifts) >= max(2, _LIFTS * len(body.height) / fps)


def _tiptoes(body: _Body) -> bool:
    """Whether the heel over the lower foot is up most of the time, however high the floor."""
    toes = np.stack([body.level("left_foot"), body.level("right_foot")])
    heels = np.stack([body.level("left_ankle"), body.level("right_ankle")])
    lower = toes.argmin(axis=0)[None]
    up = np.take_along_axis(heels - toes, lower, axis=0)[0]
    return bool((up > _HEEL_UP).mean() > _TIPTOEING)


def _hands(body: _Body, fps: float) -> list[Finding]:
    head = body.level("head")
    wrists = {side: body.level(f"{side}_wrist") for side in ("left", "right")}
    shoulders = {side: body.level(f"{side}_shoulder") for side in wrists}
    up = {side: wrists[side] > head for side in wrists}
    down = {side: (wrists[side] < shoulders[side]).all() for side in wrists}
    speeds = {side: body.speed(f"{side}_wrist", fps) for side in wrists}
    fastest = {side: speed.max(initial=0.0) for side, speed in speeds.items()}
    found = []
    swings = {
        side: _swings(body.place(f"{side}_wrist"), wrists[side] > shoulders[side])
        for side in wrists
    }
    held = max(swings.values()) < 2
    if min(swings.values()) >= _WAVES:
        found.append(Finding("both hands wave"))
    elif (up["left"] & up["right"]).mean() > _HELD and held:
        found.append(Finding("both hands up"))
    for side, own, other in ((1, "left", "right"), (-1, "right", "left")):
        if swings[own] >= _WAVES and down[other]:
            found.append(Finding("one hand waves", side))
        elif up[own].mean() > _HELD and down[other] and held:
            found.append(Finding("one hand up", side))
        if fastest[own] > _QUICK and fastest[other] < _CALM:
            found.append(Finding("one arm fast", side))
    apart = np.linalg.norm(body.place("left_wrist") - body.place("right_wrist"), axis=-1)
    slower = np.minimum(speeds["left"], speeds["right"])
    if ((slower > _QUICK) & (apart[1:-1] < _GRIP)).any() and (apart < _GRIP).mean() > 2 * _HELD:
        found.append(Finding("two-handed swing"))
    level = np.max([np.abs(wrists[side] - shoulders[side]) for side in wrists], axis=0) < 0.25
    if ((apart > _SPREAD) & level).mean() > _HELD:
        found.append(Finding("arms out"))
    return found


def _swings(wrist: Array, raised: NDArray[np.bool_]) -> int:
    """Return how often a wrist [T, 3] turns back, to the side or ahead, while it is raised [T]."""
    frames = np.flatnonzero(raised)
    if not len(frames):
        return 0
    path = wrist[frames[0] : frames[-1] + 1]
    turns = [
        sum(len(_peaks(sign * path[:, axis], prominence=_SWING)) for sign in (1, -1))
        for axis in (0, 2)
    ]
    return max(turns)


def _peaks(values: Array, **least: float) -> NDArray[np.intp]:
    from scipy.signal import find_peaks  # half a second that only training needs

    return find_peaks(values, **least)[0]
