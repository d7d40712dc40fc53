"""Rates from values over time, and back."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion.rotations import Array


def forward_difference(x: Array, fps: float) -> Array:
    """Return per-second forward differences along axis 0; the last one is repeated."""
    if len(x) < 2:
        return np.zeros_like(x)
    step = np.diff(x, axis=0) * fps
    return np.concatenate([step, step[-1:]])


def integrate(rate: Array, fps: float) -> Array:
    """Undo `forward_difference`, starting at zero."""
    return np.concatenate([np.zeros_like(rate[:1]), np.cumsum(rate[:-1], axis=0) / fps])
