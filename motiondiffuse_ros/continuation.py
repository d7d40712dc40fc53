"""A motion that goes on where another one was left."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from motiondiffuse_ros.kept import Kept
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.resample import sample_at
from motiondiffuse_ros.motion.root_path import PathPoint
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.repair import stance_height
from motiondiffuse_ros.robots.start_state import StartState

LEAD_IN = 1.0
"""Of the motion before the seam, what the sampler is shown [s]."""

SETTLE = 1.0
"""Time over which a correction of the floor's height sets in after the seam [s]."""


@dataclass(frozen=True, eq=False)
class Start:
    """What a motion continues.

    Attributes:
        lead_in: What the body did up to the seam, which is the last frame; at any rate, in the
            world frame in which the new motion goes on. None starts afresh over the origin.
        state: Of the robot where the trajectory starts; None starts at the motion's first frame.
    """

    lead_in: Motion | None = field(default=None, repr=False)
    state: StartState | None = None


@dataclass(frozen=True, eq=False)
class Continuation:
    """A lead-in as the sampler takes it.

    Attributes:
        kept: The lead-in and how it is let go.
        frames: Frames before the seam, which are cut off the result.
    """

    kept: Kept
    frames: int

    @property
    def seam(self) -> PathPoint:
        """The root at the seam, in the frame of what is sampled."""
        x, y, _ = self.kept.motion.root[self.frames].tolist()
        return PathPoint(self.frames, x, y, float(self.kept.motion.heading[self.frames]))


def continue_from(lead_in: Motion, frames: int, fps: float, feature_dim: int) -> Continuation:
    """Prepare the sampler to go on from a lead-in.

    Args:
        lead_in: Up to the seam; its last `LEAD_IN` seconds count.
        frames: Length of the motion from the seam on.
        fps: Rate of the model, Hz.
        feature_dim: Width of its features.
    """
    before = int(np.clip(np.floor(lead_in.duration * fps + 1e-6), 1, round(LEAD_IN * fps)))
    times = lead_in.duration - np.arange(before, -1, -1) / fps
    shown = sample_at(lead_in, np.maximum(times, 0.0), fps)
    motion = _carried_on(shown, before + frames).canonicalised()
    rows = np.arange(motion.frames) <= before
    return Continuation(Kept(motion, rows, np.zeros(feature_dim, dtype=bool)), before)


def rejoin(motion: Motion, lead_in: Motion, frames: int) -> Motion:
    """Cut the lead-in off a sampled motion and put the rest where the lead-in ended.

    Heights set out from those of the lead-in; how far the stance is off the floor is taken out
    over `SETTLE` seconds.
    """
    last = lead_in.slice(lead_in.frames - 1, lead_in.frames)
    motion = placed(motion.slice(frames, motion.frames), last)
    gain = np.clip(np.arange(motion.frames) / (SETTLE * motion.fps), 0.0, 1.0)
    gain = gain**3 * (10.0 - 15.0 * gain + 6.0 * gain**2)
    lowered = np.outer(gain * stance_height(motion), [0.0, 0.0, 1.0])
    return motion.with_root(motion.root - lowered)


def placed(motion: Motion, pose: Motion) -> Motion:
    """Move a motion on the ground plane so that it starts where the first frame of another is."""
    return moved_to(motion, pose.root[0], float(pose.heading[0]))


def moved_to(motion: Motion, position: Array, heading: float) -> Motion:
    """Move a motion on the ground plane to a starting place and heading [rad]; heights stay."""
    motion = motion.canonicalised()
    turn = rot.about_axis(2, np.array(heading))
    rotations = motion.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    root = rot.rotate(turn, motion.root) + np.asarray(position) * [1.0, 1.0, 0.0]
    return replace(motion, root=root, rotations=rotations)


def _carried_on(motion: Motion, frames: int) -> Motion:
    """Append what the last frames' speeds, dying away, lead to: `frames` and one more in all."""
    count = frames - motion.frames
    travelled = np.cumsum(0.7 ** np.arange(1, count + 1))
    step = motion.root[-1] - motion.root[-2]
    turn = rot.to_rotation_vector(
        rot.multiply(rot.conjugate(motion.rotations[-2]), motion.rotations[-1])
    )
    root = motion.root[-1] + travelled[:, None] * step
    rotations = rot.multiply(
        motion.rotations[-1], rot.from_rotation_vector(travelled[:, None, None] * turn)
    )
    return replace(
        motion,
        root=np.concatenate([motion.root, root]),
        rotations=np.concatenate([motion.rotations, rotations]),
    )
