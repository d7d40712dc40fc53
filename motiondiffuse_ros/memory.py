"""What the allocator does with freed memory."""

from __future__ import annotations

import ctypes
import gc

_TRIM_THRESHOLD, _TOP_PAD, _MMAP_MAX, _ARENA_MAX = -1, -2, -4, -8  # of <malloc.h>


def keep_freed_memory() -> bool:
    """Let glibc keep what is freed; returns whether this C library can.

    By default large tensors go back to the system and are faulted in anew at every step, which
    costs a sixth of the time (docs/training.md).
    """
    return _set({_MMAP_MAX: 0, _TRIM_THRESHOLD: 2**31 - 1, _TOP_PAD: 2**28})


def share_freed_memory() -> bool:
    """Let threads to come use what others freed; returns whether this C library can.

    By default glibc gives every new thread a pool of its own, of which up to 64 MiB at its end are
    not given back, not even by `malloc_trim`. Pools that exist already stay.
    """
    return _set({_ARENA_MAX: 1})


def return_freed_memory() -> None:
    """Give what is no longer used back to the system, where the C library is glibc.

    Weights are parts of reference cycles, and the C library keeps what is freed.
    """
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)


def _set(options: dict[int, int]) -> bool:
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    return mallopt is not None and all(mallopt(*option) for option in options.items())
