"""What runs of training have in common: decayed weights and the way of the learning rate."""

from __future__ import annotations

import math
from typing import Any

from torch import nn


def parameter_groups(module: nn.Module, weight_decay: float) -> list[dict[str, Any]]:
    """Return a module's parameters for an optimiser; only matrices decay."""
    matrices = [p for p in module.parameters() if p.ndim > 1]
    rest = [p for p in module.parameters() if p.ndim <= 1]
    return [
        {"params": matrices, "weight_decay": weight_decay},
        {"params": rest, "weight_decay": 0.0},
    ]


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
