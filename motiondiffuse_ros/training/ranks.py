"""The processes that train one denoiser together, each on windows of its own."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import torch
import torch.distributed as dist
from torch import nn
from torch.nn.parallel import DistributedDataParallel

_SEEDS_APART = 10**9  # more than a run has steps, which are added to seeds


@dataclass(frozen=True)
class Ranks:
    """One of `size` processes.

    Attributes:
        rank: Which one, from 0.
        size: How many there are.
        device: Where this one's denoiser runs.
    """

    rank: int = 0
    size: int = 1
    device: torch.device = field(default_factory=lambda: torch.device("cpu"))

    @property
    def first(self) -> bool:
        """Whether this is the process that validates, logs and saves."""
        return self.rank == 0

    def seed(self, seed: int) -> int:
        """Return the seed of what this process draws; that of the first is `seed` itself."""
        return seed + self.rank * _SEEDS_APART

    def together(self, model: nn.Module) -> nn.Module:
        """Return the model with gradients that are the mean over all processes.

        All processes have to call this, and go on from the first one's weights.
        """
        return model if self.size == 1 else DistributedDataParallel(model)

    def agree(self, seconds: float, stop: bool) -> tuple[float, bool]:
        """Return the longest training time of all processes [s], and whether any wants to stop.

        What depends on them then happens at the same step everywhere: a process that went on
        alone would wait for the others' gradients for ever.
        """
        if self.size == 1:
            return seconds, stop
        values = torch.tensor([seconds, float(stop)], dtype=torch.float64, device=self.device)
        dist.all_reduce(values, dist.ReduceOp.MAX)
        longest, stops = values.tolist()
        return longest, bool(stops)

    def wait(self) -> None:
        """Return when all processes have come here."""
        if self.size > 1:
            dist.barrier()


ALONE = Ranks()


@contextmanager
def joined() -> Iterator[Ranks]:
    """Join the processes that torchrun started; without torchrun there is this one alone.

    They talk through NCCL where CUDA is, each with the graphics card of its number, and through
    gloo elsewhere.
    """
    if not dist.is_torchelastic_launched():
        yield ALONE
        return
    device = torch.device("cpu")
    if torch.cuda.is_available():
        device = torch.device("cuda", int(os.environ["LOCAL_RANK"]))
        torch.cuda.set_device(device)
    dist.init_process_group("gloo" if device.type == "cpu" else "nccl")
    try:
        yield Ranks(dist.get_rank(), dist.get_world_size(), device)
    finally:
        dist.destroy_process_group()
