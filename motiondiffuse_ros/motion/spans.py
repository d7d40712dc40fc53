"""Spans of frames."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the runs of True in flags [T] as (start, stop)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def pieces(count: int, size: int) -> list[slice]:
    """Return slices of at most `size` that cover `count` frames; an empty one if there are none."""
    return [slice(i, min(i + size, count)) for i in range(0, max(count, 1), size)]
