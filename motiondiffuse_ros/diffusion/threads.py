"""How many processor cores the denoiser takes."""

from __future__ import annotations

import os

import torch


def use_threads(count: int) -> None:
    """Set the threads of matrix products, for threads that have made none yet.

    Args:
        count: How many; 0 leaves a core to everybody else, unless OMP_NUM_THREADS says how many.
            Threads wait for each other by spinning: on 2 cores, beside one other busy process, two
            take half as long again as one.
    """
    if count > 0:
        torch.set_num_threads(count)
    elif "OMP_NUM_THREADS" not in os.environ:
        torch.set_num_threads(max(1, len(os.sched_getaffinity(0)) - 1))
