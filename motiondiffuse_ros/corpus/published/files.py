"""Reading files of published data sets: what is wrong is said with the file's name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion.rotations import Array


def require(path: Path, what: str) -> Path:
    """Return the path if it exists.

    Raises:
        CorpusError: If it does not; says what should be there.
    """
    if not path.exists():
        raise CorpusError(f"{path}: missing; {what}")
    return path


def read_lines(path: Path, what: str) -> list[str]:
    """Return the lines of a text file that hold something, stripped."""
    try:
        lines = require(path, what).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise CorpusError(f"{path}: cannot be read ({error}); {what}") from error
    return [line.strip() for line in lines if line.strip()]


def read_array(path: Path, shape: Sequence[int]) -> Array:
    """Read a `.npy` file of frames.

    Args:
        path: The file.
        shape: What one frame must be, e.g. (24, 3).

    Raises:
        CorpusError: If it cannot be read or is of another shape.
    """
    try:
        array = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise CorpusError(f"{path}: not a numpy array ({error})") from error
    return check_frames(array, shape, str(path))


def check_frames(array: Array, shape: Sequence[int], where: str) -> Array:
    """Return an array of numbers [T, *shape], T at least 1.

    Raises:
        CorpusError: If it is of another shape or kind; names the place.
    """
    expected = ", ".join(map(str, ("T", *shape)))
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        raise CorpusError(f"{where}: not an array of numbers; expected [{expected}]")
    if array.ndim != 1 + len(shape) or array.shape[1:] != tuple(shape) or len(array) == 0:
        raise CorpusError(f"{where}: has shape {array.shape}; expected [{expected}]")
    return array
