"""Values that parameters of a network start from."""

from __future__ import annotations

import torch
from torch import nn


def small_normal(*shape: int) -> nn.Parameter:
    """Return normally distributed values of standard deviation 0.02, for positions and the like."""
    values = torch.empty(shape)
    if not values.is_meta:  # which has none, and would load torch's compiler to draw them
        nn.init.normal_(values, std=0.02)
    return nn.Parameter(values)
