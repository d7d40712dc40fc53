"""How well composed motions hang together: at transitions in time, and at seams between parts.

In time by the measures of the field: peak and area of jerk (FlowMDM, Barquero et al., CVPR 2024,
as its `runners/eval.py` takes them) and transition distance (STMC, Petrovich et al., CVPR Workshops
2024, after TEACH, as its `mtt/stmc_metrics.py` takes it). In space by two of our own, for which the
field has none.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.differences import integrate
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.frames import vectors_to_z_up
from motiondiffuse_ros.motion.parts import PARTS, part_joints
from motiondiffuse_ros.motion.rotations import Array

WINDOW_SECONDS = 1.0
"""FlowMDM looks at 30 frames at 30 fps around a transition of BABEL: one second."""

_CARRIER = {
    "left_arm": "spine3",
    "right_arm": "spine3",
    "head": "spine3",
    "torso": "pelvis",
    "legs": "spine1",
}
"""The joint of the neighbouring part in whose frame a part's own movement is seen."""


def max_jerk(motion: Motion) -> Array:
    """Return the largest jerk among the joints at every frame [T - 3], m/s^3.

    Third differences of world positions times the cube of the rate, L1 norm over x, y, z, maximum
    over joints: FlowMDM's, which leaves out the rate and so counts in m per frame^3. A difference
    between frames i and i + 3 has index i.
    """
    jerk = np.diff(motion.positions, n=3, axis=0) * motion.fps**3
    return np.abs(jerk).sum(axis=-1).max(axis=-1)


def around(motion: Motion, frame: int, seconds: float = WINDOW_SECONDS) -> Motion | None:
    """Return the window centred on the transition to `frame`, or None if it leaves the motion."""
    count = round(seconds * motion.fps)
    start = frame - count // 2
    return motion.slice(start, start + count) if 0 <= start <= motion.frames - count else None


def jerk_curve(windows: Iterable[Motion]) -> Array:
    """Return the mean over transitions of `max_jerk` at every place of the window [W - 3]."""
    return np.mean([max_jerk(window) for window in windows], axis=0)


def peak_jerk(curve: Array) -> float:
    """Return the peak jerk (PJ) of FlowMDM, m/s^3: the maximum of `jerk_curve`."""
    return float(curve.max())


def area_under_jerk(curve: Array, usual: float, fps: float) -> float:
    """Return the area under the jerk (AUJ) of FlowMDM, m/s^2.

    The sum over the window of how far `jerk_curve` is from `usual`, the mean of `max_jerk` over
    real motion, times the frame time: FlowMDM sums over 30 fps frames without it, which would make
    the area depend on the rate.
    """
    return float(np.abs(curve - usual).sum() / fps)


def transition_distance(motion: Motion, frames: Sequence[int]) -> Array:
    """Return how far the pose moves in the step to each of some frames [N], m.

    Mean over joints of the Euclidean distance between the joints of the frame and of the one
    before it, each relative to the root and turned by its own heading: STMC's, which prints it in
    cm. At 20 fps, as there.
    """
    at = np.asarray(frames, dtype=int)
    local = _in_heading(motion, motion.positions - motion.positions[:, :1])
    return np.linalg.norm(local[at] - local[at - 1], axis=-1).mean(axis=-1)


def seam_jerk(motion: Motion, parts: Iterable[str]) -> float:
    """Return the jerk of parts as the neighbouring part sees them, m/s^3.

    The mean over frames and the parts' joints of the norm of the third difference of their
    positions in the frame of the joint that carries the part (arms and head: upper spine; torso:
    pelvis; legs: lower spine), so that a part that shakes at its seam is not hidden by the steps
    of the legs. Ours. Real motion's value is the mark, not zero.
    """
    total = []
    for part in parts:
        carrier = motion.skeleton.index(_CARRIER[part])
        offset = motion.positions[:, list(part_joints(part))] - motion.positions[:, None, carrier]
        inverse = rot.conjugate(motion.global_rotations[:, None, carrier])
        jerk = np.diff(rot.rotate(inverse, offset), n=3, axis=0) * motion.fps**3
        total.append(np.linalg.norm(jerk, axis=-1).mean())
    return float(np.mean(total))


def seam_gap(features: Array, fps: float, parts: Iterable[str]) -> float:
    """Return how far parts are from where the other parts carry them, m.

    A pose state says twice where a joint is: as a position, which only the window that owns the
    joint has a say in, and by the rotations from the root to it, most of which other windows own
    where texts on different parts meet. The mean distance of the two over frames and the parts'
    joints is what the parts disagree by: zero for real motion, small for a text alone, and large
    where an arm was imagined on another body than it was put on. Ours.

    Args:
        features: Pose states [T, 269], not normalised, as sampled.
        fps: Their rate, Hz.
        parts: Whose joints.
    """
    state = PoseState()
    motion = state.decode(features, fps)
    split = state.split(features)
    # said and carried positions are both relative to the floor under the root, in its heading
    said = vectors_to_z_up(split["positions"])
    ground = motion.positions[:, :1] * [1.0, 1.0, 0.0]
    yaw = integrate(split["yaw_velocity"][:, 0], fps)
    carried = rot.rotate(rot.about_axis(2, -yaw)[:, None], motion.positions - ground)
    joints = [j for part in parts for j in part_joints(part) if j > 0]
    gap = np.linalg.norm(carried[:, joints] - said[:, [j - 1 for j in joints]], axis=-1)
    return float(gap.mean())


def only_part(motion: Motion, parts: Iterable[str], stand: Motion) -> Motion:
    """Return the motion with every other part as it stands.

    Args:
        motion: Any.
        parts: That keep their movement; with `legs` goes the path of the root.
        stand: One frame of a standing body.
    """
    kept = set(parts)
    root, rotations = motion.root, motion.rotations.copy()
    for part in PARTS:
        if part not in kept:
            joints = list(part_joints(part))
            rotations[:, joints] = stand.rotations[:1, joints]
    if "legs" not in kept:
        root = np.repeat(stand.root[:1], motion.frames, axis=0)
    return Motion(root, rotations, motion.fps, motion.skeleton)


def _in_heading(motion: Motion, vectors: Array) -> Array:
    """Turn world vectors [T, J, 3] into the frame of the root's heading."""
    return rot.rotate(rot.about_axis(2, -motion.heading)[:, None], vectors)
