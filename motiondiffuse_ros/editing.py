"""From the `edit` of a request to what the sampler keeps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from motiondiffuse_ros.edit import Edit
from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.kept import Kept
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.parts import PARTS
from motiondiffuse_ros.motion.root_path import PathPoint
from motiondiffuse_ros.motion_file import read_motion


def kept_by(edit: Edit, frames: int, fps: float, representation: Representation) -> Kept:
    """Read the motion to edit and return what is kept of it.

    Args:
        edit: Valid.
        frames: Length of the request's motion at the model's rate.
        fps: That rate, Hz.
        representation: Which features a part owns.

    Raises:
        MotionFileError: If the file cannot be read as a motion.
        RequestError: If it is longer or shorter than the request's motion.
    """
    motion = read_motion(Path(edit.motion)).resample(fps).canonicalised()
    if abs(motion.frames - frames) > 1:
        raise RequestError(
            f"edit: {edit.motion} lasts {motion.duration:.2f} s, the request's motion "
            f"{(frames - 1) / fps:.2f} s; they must be of one length"
        )
    motion = _of_length(motion, frames)
    rows = np.zeros(frames, dtype=bool)
    points: dict[int, PathPoint] = {}
    for start, end in edit.keep:
        first, last = round(start * fps), min(round(end * fps), frames - 1)
        rows[first : last + 1] = True
        points |= {i: _point(motion, i) for i in (first, last) if i > 0}
    columns = np.zeros(representation.dim, dtype=bool)
    if edit.regenerate:
        for part in set(PARTS) - set(edit.regenerate):
            columns[representation.part_indices(part)] = True
    rooted = bool(columns[representation.part_indices("legs")].all())
    # with the root kept in all frames, every frame is in its place already
    return Kept(motion, rows, columns, () if rooted else tuple(points.values()))


def keeps_height(kept: Kept, representation: Representation) -> bool:
    """Return whether some of the root's own frames are kept, so that heights may not be moved."""
    return bool(kept.mask[:, representation.part_indices("legs")].any())


def _of_length(motion: Motion, frames: int) -> Motion:
    """Cut a frame off, or repeat the last."""
    if motion.frames >= frames:
        return motion.slice(0, frames)
    index = np.minimum(np.arange(frames), motion.frames - 1)
    return Motion(motion.root[index], motion.rotations[index], motion.fps)


def _point(motion: Motion, frame: int) -> PathPoint:
    x, y, _ = motion.root[frame].tolist()
    return PathPoint(frame, x, y, float(motion.heading[frame]))
