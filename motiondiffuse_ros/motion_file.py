"""Motion files of any kind that this package reads."""

from __future__ import annotations

from pathlib import Path

from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.input_file import MOST_MOTION, check_size, is_file
from motiondiffuse_ros.motion import Motion


def read_motion(file: Path) -> Motion:
    """Read a motion.npz of this package, or a BVH file of a known skeleton.

    Raises:
        MotionFileError: If there is none, or it is too large or cannot be read as a motion.
    """
    if not is_file(file):
        raise MotionFileError(f"{file}: no such file")
    check_size(file, MOST_MOTION, MotionFileError)
    if file.suffix == ".npz":
        return Motion.load_npz(file)
    if file.suffix == ".bvh":
        from motiondiffuse_ros.corpus import load_motion

        return load_motion(file)
    raise MotionFileError(f"{file}: a motion is a .bvh or a .npz file")
