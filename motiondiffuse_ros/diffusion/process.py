"""The diffusion process: noise schedules and samplers of diffusers, selected by name."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from functools import cache
from typing import Any

from torch import Tensor

from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.light_import import light_import

with light_import():
    from diffusers.schedulers.scheduling_ddpm import DDPMScheduler
    from diffusers.schedulers.scheduling_dpmsolver_multistep import DPMSolverMultistepScheduler

SCHEDULERS = ("ddim", "ddpm", "dpm-solver++")

Scheduler = DDPMScheduler | DPMSolverMultistepScheduler


def make_scheduler(name: str, config: DenoiserConfig) -> Scheduler:
    """Return a new sampler for a denoiser's noise schedule.

    Args:
        name: One of `SCHEDULERS`; "ddpm" with all steps is the paper's.
        config: Of the denoiser.

    Raises:
        RequestError: If there is no such scheduler.
    """
    return deepcopy(_scheduler(name, config))


@cache  # the schedule of noise takes a loop over all training steps
def _scheduler(name: str, config: DenoiserConfig) -> Scheduler:
    common: dict[str, Any] = {
        "num_train_timesteps": config.train_steps,
        "beta_schedule": config.beta_schedule,
        "beta_start": config.beta_start,
        "beta_end": config.beta_end,
        "prediction_type": config.prediction_type,
    }
    # features are normalised, not bounded: samples are never clipped
    if name == "ddpm":
        return DDPMScheduler(**common, clip_sample=False)
    if name in ("ddim", "dpm-solver++"):
        # of the first order it is DDIM (Lu et al. 2022), with steps at any times
        order = 1 if name == "ddim" else 2
        return DPMSolverMultistepScheduler(
            **common, algorithm_type="dpmsolver++", solver_order=order
        )
    raise RequestError(f"unknown scheduler '{name}'; the schedulers are {', '.join(SCHEDULERS)}")


def denoising_steps(count: int, spacing: float, train_steps: int) -> list[int]:
    """Return the training steps at which to denoise, from the noisiest to less noise.

    A text decides what a motion does while there is almost nothing but noise (docs/training.md), so
    that steps at even distances are too few there and too many where details are left.

    Args:
        count: How many, at most `train_steps`.
        spacing: The i-th of n is at 1 - (i / n) ** spacing of the training steps; 1 is even.
        train_steps: Of the denoiser.
    """
    steps: list[int] = []
    for i in range(count):
        step = round(train_steps * (1.0 - (i / count) ** spacing)) - 1
        before = steps[-1] if steps else train_steps
        steps.append(max(min(step, before - 1), count - 1 - i))
    return steps


def keep_rows(scheduler: Scheduler, rows: Sequence[int]) -> None:
    """Let a scheduler that is under way go on with some rows of its batch."""
    if isinstance(scheduler, DPMSolverMultistepScheduler):
        outputs = scheduler.model_outputs
        scheduler.model_outputs = [None if x is None else x[list(rows)] for x in outputs]


def to_clean(kind: str, output: Tensor, noisy: Tensor, alpha: Tensor) -> Tensor:
    """Return the clean features that a prediction stands for.

    Args:
        kind: `DenoiserConfig.prediction_type`: sample, epsilon or v_prediction.
        output: The prediction.
        noisy: What it was made of.
        alpha: Cumulative product of the schedule at that step, broadcast to both.
    """
    if kind == "sample":
        return output
    if kind == "v_prediction":
        return alpha.sqrt() * noisy - (1 - alpha).sqrt() * output
    return (noisy - (1 - alpha).sqrt() * output) / alpha.sqrt()


def from_clean(kind: str, clean: Tensor, noisy: Tensor, alpha: Tensor) -> Tensor:
    """Undo `to_clean`."""
    if kind == "sample":
        return clean
    if kind == "v_prediction":
        return (alpha.sqrt() * noisy - clean) / (1 - alpha).sqrt()
    return (noisy - alpha.sqrt() * clean) / (1 - alpha).sqrt()
