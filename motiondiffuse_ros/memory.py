"""What the allocator does with freed memory."""

from __future__ import annotations

import ctypes
import gc

_TRIM_THRESHOLD, _TOP_PAD, _MMAP_MAX = -1, -2, -4  # of <malloc.h>


def keep_freed_memory() -> bool:
    """Let glibc keep what is freed; returns whether this C library can.

    By default large tensors go back to the system and are faulted in anew at every step, which
    costs a sixth of the time (docs/training.md).
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is None:
        return False
    largest = 2**31 - 1
    settings = ((_MMAP_MAX, 0), (_TRIM_THRESHOLD, largest), (_TOP_PAD, 2**28))
    return sum(mallopt(name, value) for name, value in settings) == len(settings)


def return_freed_memory() -> None:
    """Give what is no longer used back to the system, where the C library is glibc.

    Weights are parts of reference cycles, and each thread keeps what it freed for itself.
    """
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
