"""What runs of training have in common: optimiser, learning rate and averaged weights."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import torch
from diffusers.training_utils import EMAModel
from torch import nn


def make_optimizer(
    module: nn.Module, *, learning_rate: float, weight_decay: float
) -> torch.optim.AdamW:
    """Return an optimiser of a module's parameters; only matrices decay."""
    matrices = [p for p in module.parameters() if p.ndim > 1]
    rest = [p for p in module.parameters() if p.ndim <= 1]
    groups = [
        {"params": matrices, "weight_decay": weight_decay},
        {"params": rest, "weight_decay": 0.0},
    ]
    return torch.optim.AdamW(groups, lr=learning_rate, betas=(0.9, 0.99), fused=True)


def make_average(module: nn.Module, decay: float) -> EMAModel:
    """Return the running average of a module's parameters, with this decay at most."""
    return EMAModel(module.parameters(), decay=decay, use_ema_warmup=True, power=0.75)


@contextmanager
def averaged(module: nn.Module, average: EMAModel) -> Iterator[None]:
    """Let a module that is trained have its averaged weights, in evaluation mode, for a while."""
    parameters = list(module.parameters())
    average.store(parameters)
    average.copy_to(parameters)
    module.eval()
    try:
        yield
    finally:
        module.train()
        average.restore(parameters)


def learning_rate(peak: float, *, step: int, warmup_steps: int, done: float) -> float:
    """Return the learning rate of a step: linear warm-up, then a cosine over the run's time.

    Args:
        peak: Of the schedule.
        step: From 0.
        warmup_steps: Steps of linear warm-up.
        done: Part of the run's time that is over, 0 to 1 and beyond.
    """
    warmup = min(1.0, (step + 1) / max(warmup_steps, 1))
    # ends at 1 % rather than zero: the last minutes of a run still learn
    return peak * warmup * (0.505 + 0.495 * math.cos(math.pi * min(1.0, done)))
