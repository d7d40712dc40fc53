"""The diffusion process: noise schedules and samplers of diffusers, selected by name."""

from __future__ import annotations

from typing import Any

from diffusers.schedulers.scheduling_ddim import DDIMScheduler
from diffusers.schedulers.scheduling_ddpm import DDPMScheduler
from diffusers.schedulers.scheduling_dpmsolver_multistep import DPMSolverMultistepScheduler
from torch import Tensor

from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.errors import RequestError

SCHEDULERS = ("ddim", "ddpm", "dpm-solver++")

Scheduler = DDIMScheduler | DDPMScheduler | DPMSolverMultistepScheduler


def make_scheduler(name: str, config: DenoiserConfig) -> Scheduler:
    """Return a sampler for a denoiser's noise schedule.

    Args:
        name: One of `SCHEDULERS`; "ddpm" with all steps is the paper's.
        config: Of the denoiser.

    Raises:
        RequestError: If there is no such scheduler.
    """
    common: dict[str, Any] = {
        "num_train_timesteps": config.train_steps,
        "beta_schedule": config.beta_schedule,
        "beta_start": config.beta_start,
        "beta_end": config.beta_end,
        "prediction_type": config.prediction_type,
        "timestep_spacing": "trailing",
    }
    # features are normalised, not bounded: samples are never clipped
    if name == "ddim":
        return DDIMScheduler(**common, clip_sample=False)
    if name == "ddpm":
        return DDPMScheduler(**common, clip_sample=False)
    if name == "dpm-solver++":
        return DPMSolverMultistepScheduler(**common, algorithm_type="dpmsolver++")
    raise RequestError(f"unknown scheduler '{name}'; the schedulers are {', '.join(SCHEDULERS)}")


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
