"""The whole repair: ground height, a root without jerks, feet that stand; never against physics."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.measures import MIN_FRAMES, RATE
from motiondiffuse_ros.physics.repair.foot_lock import lock_feet
from motiondiffuse_ros.physics.repair.ground import follow_floor, put_on_floor
from motiondiffuse_ros.physics.report import IMPLAUSIBLE, MARGINAL, PLAUSIBLE, Report, assess

_WINDOW, _DEGREE = 7, 3
_VERDICTS = (IMPLAUSIBLE, MARGINAL, PLAUSIBLE)


@dataclass(frozen=True, eq=False)
class Repair:
    """A motion and what physics says of it before and after.

    Attributes:
        motion: The repaired motion, or the given one where any repair would have made it worse.
        before: Report on the motion as it was given.
        after: Report on `motion`.
    """

    motion: Motion = field(repr=False)
    before: Report
    after: Report

    @property
    def report(self) -> Report:
        """`after`, with the figures before if they are others."""
        if self.after is self.before:
            return self.after
        return replace(self.after, before_repair=self.before.metrics)


def repair(
    motion: Motion,
    judge: Callable[[Motion], Report] | None = None,
    before: Report | None = None,
) -> Repair:
    """Repair a motion, unless that makes it less plausible.

    Where the whole repair does, it is put on the floor and no more; where that does, it stays.

    Args:
        motion: At any rate; one that is not finite or too short is returned as it is.
        judge: Makes the reports; `assess` without simulation if None.
        before: What it says of `motion`, if that is known.
    """
    judge = judge or _assessed
    before = before or judge(motion)
    if motion.frames < MIN_FRAMES or before.score == 0.0:
        return Repair(motion, before, before)
    on_floor = smooth_root(follow_floor(put_on_floor(motion)))
    for change in (lock_feet, _unchanged):
        repaired = _started_at(change(on_floor), motion.root[0])
        after = judge(repaired)
        if not worse(after, before):
            return Repair(repaired, before, after)
    return Repair(motion, before, before)


def repair_best(
    candidates: Mapping[int, Motion],
    judge: Callable[[Motion], Report] | None = None,
) -> tuple[int, Repair]:
    """Repair candidates one after the other, in their order, until one is plausible.

    Args:
        candidates: At least one; those that are preferred come first.
        judge: As for `repair`.

    Returns:
        The plausible one, or the one with the best score after repair, by its key; and its repair.
    """
    repaired: dict[int, Repair] = {}
    for i, motion in candidates.items():
        repaired[i] = repair(motion, judge)
        if repaired[i].after.verdict == PLAUSIBLE:
            return i, repaired[i]
    best = max(repaired, key=lambda i: repaired[i].after.score)
    return best, repaired[best]


def worse(after: Report, before: Report) -> bool:
    """Say whether a repair has a worse verdict or sins more against physics.

    The fitted score alone does not count: it knows how recorded feet move, and those are never as
    still on the floor as held ones.
    """
    if _VERDICTS.index(after.verdict) < _VERDICTS.index(before.verdict):
        return True
    now, then = (r.metrics.get("criteria_score") or 0.0 for r in (after, before))
    return now < then and after.score < before.score


def repaired_motion(motion: Motion) -> Motion:
    """Put a motion on the floor, smooth its root and lock its feet, whatever comes of it.

    It still starts over the same point of the floor.
    """
    on_floor = smooth_root(follow_floor(put_on_floor(motion)))
    return _started_at(lock_feet(on_floor), motion.root[0])


def _started_at(motion: Motion, place: Array) -> Motion:
    away = (motion.root[0] - place) * np.array([1.0, 1.0, 0.0])
    return motion.with_root(motion.root - away)


def _unchanged(motion: Motion) -> Motion:
    return motion


def smooth_root(motion: Motion) -> Motion:
    """Smooth the path of the root by local cubics, which keep its momentum (Savitzky-Golay)."""
    frames = round(_WINDOW * motion.fps / RATE) // 2 * 2 + 1
    if not _DEGREE < frames <= motion.frames:
        return motion
    return motion.with_root(_locally_fitted(motion.root, frames))


def _locally_fitted(values: Array, frames: int) -> Array:
    """Return the cubic fitted to the odd count of frames about each [T, K], at the ends one cubic.

    scipy.signal does the same, and takes half a second to load.
    """
    half = frames // 2
    powers = np.vander(np.arange(-half, half + 1), _DEGREE + 1)
    fit = powers @ np.linalg.pinv(powers)
    inner = sliding_window_view(values, frames, axis=0) @ fit[half]
    ends = fit[:half] @ values[:frames], fit[half + 1 :] @ values[-frames:]
    return np.concatenate([ends[0], inner, ends[1]])


def _assessed(motion: Motion) -> Report:
    return assess(motion, track=False)
