"""How many processor cores the denoiser takes, and how it shares work between them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True)
class Threads:
    """How work is shared; it decides the last bits of what is sampled.

    Threads of one product wait for each other by spinning: on 2 cores, beside one other busy
    process, two take half as long again as one. Halves of a batch meet once a pass, asleep.

    Attributes:
        of_products: Threads of each matrix product.
        halves: Whether the two halves of a batch are predicted at once.
    """

    of_products: int
    halves: bool = False

    @classmethod
    def of(cls, count: int) -> Threads:
        """Return how `count` threads share work.

        Args:
            count: How many; 0 is OMP_NUM_THREADS, and without it one less than the cores, though
                two if there are.
        """
        if count < 1:
            cores = len(os.sched_getaffinity(0))
            told = os.environ.get("OMP_NUM_THREADS", "")
            count = int(told) if told.isdecimal() else max(min(cores, 2), cores - 1)
        return cls(max(1, count // 2), halves=count > 1)


_halves: ThreadPoolExecutor | None = None


def threads() -> Threads:
    """Return what this process uses; at first what torch does, and no halves."""
    return Threads(torch.get_num_threads(), halves=_halves is not None)


def use_threads(wanted: Threads) -> None:
    """Share work of this process so, in threads that have made no matrix product yet."""
    global _halves
    torch.set_num_threads(wanted.of_products)
    # anew each time: a thread keeps what it had at its first product
    _halves = ThreadPoolExecutor(1, "second half") if wanted.halves else None


@contextmanager
def sharing(wanted: Threads) -> Iterator[None]:
    """Share work so for a while; see `use_threads`."""
    present = threads()
    use_threads(wanted)
    try:
        yield
    finally:
        use_threads(present)


def in_halves(work: Callable[[slice], Tensor], rows: int) -> Tensor:
    """Return what is made of a batch, in inference mode; of both halves at once if that is wanted.

    Args:
        work: Makes it of some rows, independently of the others.
        rows: How many there are.
    """
    pool = _halves
    if pool is None or rows < 2:
        return work(slice(rows))
    second = pool.submit(torch.inference_mode()(work), slice(rows // 2, rows))
    first = work(slice(rows // 2))
    return torch.cat([first, second.result()])
