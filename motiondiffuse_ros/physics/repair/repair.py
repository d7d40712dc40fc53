"""The whole repair: ground height, a root without jerks, feet that stand; never for the worse."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.signal import savgol_filter

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.measures import MIN_FRAMES, RATE
from motiondiffuse_ros.physics.repair.foot_lock import lock_feet
from motiondiffuse_ros.physics.repair.ground import put_on_floor
from motiondiffuse_ros.physics.report import Report, assess

_WINDOW, _DEGREE = 7, 3


@dataclass(frozen=True, eq=False)
class Repair:
    """A motion and what physics says of it before and after.

    Attributes:
        motion: The repaired motion, or the given one where the repair would have made it worse.
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


def repair(motion: Motion, judge: Callable[[Motion], Report] | None = None) -> Repair:
    """Repair a motion, unless that makes it less plausible.

    Args:
        motion: At any rate; one that is not finite or too short is returned as it is.
        judge: Makes the reports; `assess` without simulation if None.
    """
    judge = judge or _assessed
    before = judge(motion)
    if motion.frames < MIN_FRAMES or before.score == 0.0:
        return Repair(motion, before, before)
    repaired = repaired_motion(motion)
    after = judge(repaired)
    if after.score < before.score:
        return Repair(motion, before, before)
    return Repair(repaired, before, after)


def repaired_motion(motion: Motion) -> Motion:
    """Put a motion on the floor, smooth its root and lock its feet, whatever comes of it.

    It still starts over the same point of the floor.
    """
    repaired = lock_feet(smooth_root(put_on_floor(motion)))
    away = (repaired.root[0] - motion.root[0]) * np.array([1.0, 1.0, 0.0])
    return replace(repaired, root=repaired.root - away)


def smooth_root(motion: Motion) -> Motion:
    """Smooth the path of the root by local cubics, which keep its momentum (Savitzky-Golay)."""
    frames = round(_WINDOW * motion.fps / RATE) // 2 * 2 + 1
    if not _DEGREE < frames <= motion.frames:
        return motion
    return replace(motion, root=savgol_filter(motion.root, frames, _DEGREE, axis=0))


def _assessed(motion: Motion) -> Report:
    return assess(motion, track=False)
