"""Sampling of a composed timeline, and of many texts at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import torch
from torch import Tensor

from motiondiffuse_ros.diffusion.composition import Window
from motiondiffuse_ros.diffusion.constraints import Constraint
from motiondiffuse_ros.diffusion.denoiser import Conditioning, Denoiser
from motiondiffuse_ros.diffusion.denoising import Denoising, Planting
from motiondiffuse_ros.diffusion.guidance import GuidedDenoiser
from motiondiffuse_ros.diffusion.imagination import Imagination
from motiondiffuse_ros.diffusion.precision import use_bf16
from motiondiffuse_ros.diffusion.process import make_scheduler
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.diffusion.windowed_prediction import (
    BATCH_ROWS,
    Predictor,
    WindowedPrediction,
)

Choice = Callable[[Tensor], Sequence[int]]
"""Which candidates go on, rising, of what each is predicted to become [C, T, D], normalised."""


class Early(NamedTuple):
    """A denoiser that does the first steps instead (`FewSteps`), without guidance.

    Attributes:
        denoiser: In evaluation mode; of the other's shape.
        conditioning: Of the same texts.
        unconditional: Of the empty text.
        down_to: The last diffusion step it does.
    """

    denoiser: Denoiser
    conditioning: Conditioning
    unconditional: Conditioning
    down_to: int


class Sampled(NamedTuple):
    """What was sampled.

    Attributes:
        features: Normalised [C, T, D] float32.
        candidates: Which candidates those are, rising.
    """

    features: Tensor
    candidates: tuple[int, ...]


@torch.inference_mode()
def sample(
    denoiser: Denoiser,
    windows: Sequence[Window],
    conditioning: Conditioning,
    unconditional: Conditioning,
    config: SamplerConfig,
    early: Early | None = None,
    *,
    frames: int,
    candidates: int,
    seed: int,
    text_of: Sequence[int] | None = None,
    constraints: Sequence[Constraint] = (),
    planted: Planting | None = None,
    choose: Choice | None = None,
    on_step: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Sampled:
    """Sample normalised features.

    Args:
        denoiser: In evaluation mode.
        windows: Composed timeline; their weights sum to one.
        conditioning: A row for each text.
        unconditional: One row, of the empty text.
        config: Scheduler and guidance.
        early: Who does the first steps, if another denoiser does.
        frames: Length of the motion.
        candidates: Independent samples.
        seed: Of all noise.
        text_of: Which text each window has; one each if None.
        constraints: What the motion must keep to, met at every step and in the result.
        planted: What is imposed below `planted_below`, before the constraints.
        choose: Which candidates go on below `thinned_below`. Where they are so long that they are
            sampled one after the other, it is asked of those that went on so far and the next.
        on_step: Called with (steps done, steps in all).
        cancelled: Asked before each step.

    Returns:
        The candidates that went on.

    Raises:
        Cancelled: If `cancelled` said so.
        SamplingError: If the result is not finite.
    """
    config.validate()
    generator = torch.Generator().manual_seed(seed)
    predict = WindowedPrediction(
        _predictor(denoiser, config, conditioning, unconditional, early),
        windows,
        part_correction=config.part_correction,
        time_correction=config.time_correction,
        device=denoiser.device,
        text_of=text_of,
    )
    # one candidate of a long timeline fills a batch; others beside it only take memory
    size = max(1, BATCH_ROWS // max(len(windows), 1))
    groups = range(0, candidates, size)
    waiting: list[Denoising] = []
    motions: list[Tensor] = []
    kept: list[int] = []
    gone = 0

    def stepped() -> None:
        if on_step is not None:
            done = sum(run.done for run in waiting) + gone * config.steps
            on_step(done, len(groups) * config.steps)

    def finish(run: Denoising) -> None:
        nonlocal gone
        motions.append(run.finish())
        kept.extend(run.candidates)
        waiting.remove(run)
        gone += 1

    for first in groups:
        count = min(size, candidates - first)
        run = Denoising(
            predict,
            centred_noise((count, frames, denoiser.config.feature_dim), generator),
            denoiser,
            config,
            generator,
            first=first,
            constraints=constraints,
            planted=planted,
            imagination=_imagination(denoiser, windows, config),
            stepped=stepped,
            cancelled=cancelled,
        )
        waiting.append(run)
        if choose is None or not run.reach(config.thinned_below):
            finish(run)
            continue
        _thin(waiting, choose)
        gone += sum(not run.candidates for run in waiting)
        waiting[:] = [run for run in waiting if run.candidates]
    for run in tuple(waiting):
        finish(run)
    return Sampled(torch.cat(motions), tuple(kept))


def _thin(runs: Sequence[Denoising], choose: Choice) -> None:
    """Let those that are chosen go on."""
    chosen = choose(torch.cat([run.expected for run in runs]))
    first = 0
    for run in runs:
        count = len(run.candidates)
        run.keep([row - first for row in chosen if first <= row < first + count])
        first += count


@torch.inference_mode()
def sample_batch(
    denoiser: Denoiser,
    lengths: Tensor,
    conditioning: Conditioning,
    unconditional: Conditioning,
    config: SamplerConfig,
    early: Early | None = None,
    *,
    seed: int,
    planted: Planting | None = None,
) -> Tensor:
    """Sample one motion for each of many texts: without composition, of any lengths.

    Args:
        denoiser: In evaluation mode.
        lengths: Frames of each motion [B], at most the denoiser's window.
        conditioning: A row for each text.
        unconditional: One row, of the empty text.
        config: Scheduler and guidance.
        early: Who does the first steps, if another denoiser does.
        seed: Of all noise.
        planted: What is imposed below `planted_below`.

    Returns:
        Normalised features [B, T, D] float32; the first `lengths` frames of each count.

    Raises:
        SamplingError: If the result is not finite.
    """
    config.validate()
    generator = torch.Generator().manual_seed(seed)
    x = centred_noise((len(lengths), int(lengths.max()), denoiser.config.feature_dim), generator)
    lengths = lengths.to(denoiser.device)
    guided = _predictor(denoiser, config, conditioning, unconditional, early)
    rows = torch.arange(len(lengths))

    def predict(x: Tensor, step: int, imagination: Imagination | None) -> Tensor:
        return guided(x, step, lengths, rows)

    return Denoising(predict, x, denoiser, config, generator, planted=planted).finish()


def centred_noise(shape: Sequence[int], generator: torch.Generator | None) -> Tensor:
    """Return what sampling starts from: noise [B, T, D] whose mean over time is zero.

    The denoiser reads a mean as the hint of a heading or a speed, though the text says another.
    """
    noise = torch.randn(tuple(shape), generator=generator)
    return noise - noise.mean(dim=1, keepdim=True)


def _imagination(
    denoiser: Denoiser, windows: Sequence[Window], config: SamplerConfig
) -> Imagination | None:
    if config.apart_above >= 1.0:
        return None
    return Imagination(
        windows,
        make_scheduler(config.scheduler, denoiser.config).alphas_cumprod,
        denoiser.config.prediction_type,
        above=config.apart_above,
        device=denoiser.device,
    )


def _predictor(
    denoiser: Denoiser,
    config: SamplerConfig,
    conditioning: Conditioning,
    unconditional: Conditioning,
    early: Early | None,
) -> Predictor:
    train_steps = denoiser.config.train_steps
    times = config.times(train_steps)
    bf16 = use_bf16(config.precision, denoiser.device)

    def scale(step: int) -> float:
        return config.guidance_at(step / train_steps)

    if early is None:
        return GuidedDenoiser(denoiser, conditioning, unconditional, times, scale, bf16=bf16)
    # each its own: what stays the same over steps is made for all of them at once
    before = [step for step in times if step >= early.down_to]
    after = times[len(before) :]
    late = GuidedDenoiser(denoiser, conditioning, unconditional, after, scale, bf16=bf16)
    first = GuidedDenoiser(*early[:3], before, lambda step: 1.0, bf16=bf16)

    def predict(noisy: Tensor, step: int, lengths: Tensor, rows: Tensor) -> Tensor:
        return (first if step >= early.down_to else late)(noisy, step, lengths, rows)

    return predict
