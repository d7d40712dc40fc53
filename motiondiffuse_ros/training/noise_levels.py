"""Which noise levels are trained, and how much each counts."""

from __future__ import annotations

import torch
from torch import Tensor

NOISIEST = 0.15
"""Part of the steps that `draw_steps` can give a larger share."""

_SPACING = 2.5  # these are drawn as densely as the sampler visits them


def draw_steps(
    train_steps: int, count: int, noisiest: float, generator: torch.Generator | None = None
) -> Tensor:
    """Draw the diffusion steps [count] of a batch.

    A motion is so smooth that what it does shows through most of the noise. Only the noisiest steps
    have nothing but the text to go by, and evenly drawn they are too few to learn it
    (docs/training.md).

    Args:
        train_steps: Steps of the schedule; the last is the noisiest.
        count: How many to draw.
        noisiest: Share that is drawn from the noisiest steps alone; the others from all.
        generator: Of the draws; the global one if None.
    """
    every = torch.randint(train_steps, (count,), generator=generator)
    if noisiest == 0.0:
        return every
    depth = torch.rand(count, generator=generator) ** _SPACING * round(NOISIEST * train_steps)
    noisy = train_steps - 1 - depth.long()
    return torch.where(torch.rand(count, generator=generator) < noisiest, noisy, every)


def noise_weight(alpha: Tensor, snr_limit: float) -> Tensor:
    """Return the weight of windows by noise: their signal-to-noise ratio, 1 to a limit.

    Min-SNR weighting (Hang et al. 2023) for clean features, but never under 1: what the text
    decides is decided where noise prevails.

    Args:
        alpha: Cumulative product of the schedule at the windows' steps [B].
        snr_limit: Largest weight; 1 weighs all alike.
    """
    return (alpha / (1 - alpha)).clamp(1.0, snr_limit)
