"""The denoising loop over a composed timeline."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from motiondiffuse_ros.diffusion.composition import Window
from motiondiffuse_ros.diffusion.constraints import Constraint, apply
from motiondiffuse_ros.diffusion.denoiser import Conditioning, Denoiser
from motiondiffuse_ros.diffusion.guidance import GuidedDenoiser
from motiondiffuse_ros.diffusion.imagination import Imagination
from motiondiffuse_ros.diffusion.precision import check_precision, use_bf16
from motiondiffuse_ros.diffusion.process import (
    SCHEDULERS,
    denoising_steps,
    from_clean,
    keep_rows,
    make_scheduler,
    to_clean,
)
from motiondiffuse_ros.diffusion.windowed_prediction import BATCH_ROWS, WindowedPrediction
from motiondiffuse_ros.errors import Cancelled, RequestError, SamplingError

_FRACTIONS = (
    "part_correction",
    "time_correction",
    "apart_above",
    "planted_below",
    "thinned_below",
)

Choice = Callable[[Tensor], Sequence[int]]
"""Which candidates go on, of what each is predicted to become [C, T, D], normalised."""


@dataclass(frozen=True)
class Planting:
    """How feet are held in their places.

    Attributes:
        denoising: In clean predictions, that may still become something else.
        result: In what is returned.
    """

    denoising: Constraint
    result: Constraint


@dataclass(frozen=True)
class SamplerConfig:
    """How to sample.

    Attributes:
        scheduler: One of `SCHEDULERS`.
        steps: Denoising steps.
        spacing: How much denser they are where there is more noise; see `denoising_steps`.
        guidance_scale: Classifier-free guidance; 1 is the conditional model alone.
        guidance_interval: Noise levels, as part of the training steps, between which guidance is
            used (Kynkäänniemi et al. 2024); the conditional model alone does the rest.
        part_correction: λ₁ of eq. 10: how far texts on different parts are drawn together, 0
            (hard masks) to 1.
        time_correction: λ₂ of eq. 11: the same of neighbours in time, where they overlap.
        apart_above: Noise level, as part of the training steps, above which texts on different
            parts are denoised apart, each imagining the rest of the body; 1 is never, 0 always.
        planted_below: Noise level, as part of the training steps, below which feet in contact are
            held in their places (`motion.planted_feet`); 0 is never.
        thinned_below: Noise level, as part of the training steps, below which only chosen
            candidates go on: what a motion does is decided while there is almost nothing but noise.
        precision: Arithmetic of the denoiser, one of `PRECISIONS`.
    """

    scheduler: str = "dpm-solver++"
    steps: int = 8
    spacing: float = 2.5
    guidance_scale: float = 4.0
    guidance_interval: tuple[float, float] = (0.8, 1.0)
    part_correction: float = 0.0
    time_correction: float = 0.5
    apart_above: float = 0.0
    planted_below: float = 0.5
    thinned_below: float = 0.95
    precision: str = "auto"

    def validate(self) -> None:
        """Raise RequestError if a value is out of range."""
        if self.scheduler not in SCHEDULERS:
            raise RequestError(
                f"unknown scheduler '{self.scheduler}'; the schedulers are {', '.join(SCHEDULERS)}"
            )
        check_precision(self.precision)
        if not 1 <= self.steps <= 1000:
            raise RequestError(f"steps must be from 1 to 1000, got {self.steps}")
        if not 1.0 <= self.spacing <= 5.0:
            raise RequestError(f"spacing must be from 1 to 5, got {self.spacing}")
        for name in _FRACTIONS:
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise RequestError(f"{name} must be from 0 to 1, got {getattr(self, name)}")
        low, high = self.guidance_interval
        if not 0.0 <= low < high <= 1.0:
            raise RequestError(
                f"guidance_interval must be two rising numbers from 0 to 1, got {low}, {high}"
            )

    def guidance_at(self, noise: float) -> float:
        """Return the guidance scale at a noise level, 0 (clean) to 1."""
        low, high = self.guidance_interval
        return self.guidance_scale if low <= noise <= high else 1.0


@torch.inference_mode()
def sample(
    denoiser: Denoiser,
    windows: Sequence[Window],
    conditioning: Conditioning,
    unconditional: Conditioning,
    config: SamplerConfig,
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
) -> Tensor:
    """Sample normalised features.

    Args:
        denoiser: In evaluation mode.
        windows: Composed timeline; their weights sum to one.
        conditioning: A row for each text.
        unconditional: One row, of the empty text.
        config: Scheduler and guidance.
        frames: Length of the motion.
        candidates: Independent samples.
        seed: Of all noise.
        text_of: Which text each window has; one each if None.
        constraints: What the motion must keep to, met at every step and in the result.
        planted: What is imposed below `planted_below`, before the constraints.
        choose: Which candidates go on below `thinned_below`; all do where they are so long that
            they are sampled one after the other.
        on_step: Called with (steps done, steps in all).
        cancelled: Asked before each step.

    Returns:
        [candidates that went on, frames, D] float32.

    Raises:
        Cancelled: If `cancelled` said so.
        SamplingError: If the result is not finite.
    """
    config.validate()
    generator = torch.Generator().manual_seed(seed)
    noise = _noise((candidates, frames, denoiser.config.feature_dim), generator)
    guided = _guided(denoiser, config, conditioning, unconditional)
    # one candidate of a long timeline fills a batch; others beside it only take memory
    groups = noise.split(max(1, BATCH_ROWS // max(len(windows), 1)))
    sampled: list[Tensor] = []
    for x in groups:
        predict = WindowedPrediction(
            guided,
            windows,
            candidates=len(x),
            part_correction=config.part_correction,
            time_correction=config.time_correction,
            device=denoiser.device,
            imagination=_imagination(denoiser, windows, config),
            text_of=text_of,
        )

        def told(done: int, total: int) -> None:
            if on_step is not None:
                on_step(len(sampled) * total + done, len(groups) * total)

        sampled.append(
            _denoise(
                *(predict, x, denoiser, config, generator, constraints, planted),
                choose=_told(choose, predict) if choose and len(groups) == 1 else None,
                on_step=told,
                cancelled=cancelled,
            )
        )
    return torch.cat(sampled)


@torch.inference_mode()
def sample_batch(
    denoiser: Denoiser,
    lengths: Tensor,
    conditioning: Conditioning,
    unconditional: Conditioning,
    config: SamplerConfig,
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
        seed: Of all noise.
        planted: What is imposed below `planted_below`.

    Returns:
        Normalised features [B, T, D] float32; the first `lengths` frames of each count.

    Raises:
        SamplingError: If the result is not finite.
    """
    config.validate()
    generator = torch.Generator().manual_seed(seed)
    x = _noise((len(lengths), int(lengths.max()), denoiser.config.feature_dim), generator)
    lengths = lengths.to(denoiser.device)
    guided = _guided(denoiser, config, conditioning, unconditional)
    rows = torch.arange(len(lengths))

    def predict(x: Tensor, step: int) -> Tensor:
        return guided(x, step, lengths, rows)

    return _denoise(predict, x, denoiser, config, generator, (), planted)


def _told(choose: Choice, predict: WindowedPrediction) -> Choice:
    """Return a choice that also tells the prediction who goes on."""

    def chosen(clean: Tensor) -> Sequence[int]:
        rows = choose(clean)
        predict.keep(rows)
        return rows

    return chosen


def _noise(shape: tuple[int, int, int], generator: torch.Generator) -> Tensor:
    """Return what sampling starts from: noise [B, T, D] whose mean over time is zero.

    The denoiser reads a mean as the hint of a heading or a speed, though the text says another.
    """
    noise = torch.randn(shape, generator=generator)
    return noise - noise.mean(dim=1, keepdim=True)


def _denoise(
    predict: Callable[[Tensor, int], Tensor],
    x: Tensor,
    denoiser: Denoiser,
    config: SamplerConfig,
    generator: torch.Generator,
    constraints: Sequence[Constraint],
    planted: Planting | None,
    *,
    choose: Choice | None = None,
    on_step: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Tensor:
    late = constraints if planted is None else (planted.denoising, *constraints)
    scheduler = make_scheduler(config.scheduler, denoiser.config)
    times = denoising_steps(config.steps, config.spacing, denoiser.config.train_steps)
    scheduler.set_timesteps(timesteps=times)
    x = x.to(denoiser.device)  # drawn on the CPU: a seed means the same on every device
    total = len(scheduler.timesteps)
    for done, step in enumerate(scheduler.timesteps):
        if cancelled is not None and cancelled():
            raise Cancelled("canceled while sampling")
        output = predict(x, int(step))
        alpha, kind = scheduler.alphas_cumprod[int(step)].to(x), denoiser.config.prediction_type
        noise = step / denoiser.config.train_steps
        if choose is not None and noise < config.thinned_below:
            rows = list(choose(to_clean(kind, output, x, alpha)))
            x, output, choose = x[rows], output[rows], None
            keep_rows(scheduler, rows)
        imposed = late if noise < config.planted_below else constraints
        if imposed:
            clean = apply(imposed, to_clean(kind, output, x, alpha))
            output = from_clean(kind, clean, x, alpha)
        x = scheduler.step(output, step, x, generator=generator).prev_sample  # type: ignore[arg-type, union-attr]
        if on_step is not None:
            on_step(done + 1, total)
    if planted is not None and config.planted_below > 0.0:
        x = planted.result(x)
    x = apply(constraints, x)
    if not torch.isfinite(x).all():
        raise SamplingError(
            f"sampling gave values that are not finite (seed {generator.initial_seed()}, scheduler "
            f"{config.scheduler}, guidance scale {config.guidance_scale}); lower the guidance scale"
        )
    return x


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


def _guided(
    denoiser: Denoiser,
    config: SamplerConfig,
    conditioning: Conditioning,
    unconditional: Conditioning,
) -> GuidedDenoiser:
    train_steps = denoiser.config.train_steps
    return GuidedDenoiser(
        denoiser,
        conditioning,
        unconditional,
        denoising_steps(config.steps, config.spacing, train_steps),
        lambda step: config.guidance_at(step / train_steps),
        bf16=use_bf16(config.precision, denoiser.device),
    )
