"""The allocator's habits, set for training."""

from __future__ import annotations

import ctypes

_TRIM_THRESHOLD, _TOP_PAD, _MMAP_MAX = -1, -2, -4  # of <malloc.h>


def keep_freed_memory() -> bool:
    """Let glibc keep what is freed; returns whether this C library can.

    By default large tensors go back to the system and are faulted in anew at every step, which
    costs a sixth of the time (docs/training.md).
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except AttributeError:
        return False
    largest = 2**31 - 1
    settings = ((_MMAP_MAX, 0), (_TRIM_THRESHOLD, largest), (_TOP_PAD, 2**28))
    return sum(mallopt(name, value) for name, value in settings) == len(settings)
