"""The denoising loop over a composed timeline."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from motiondiffuse_ros.diffusion.composition import Window
from motiondiffuse_ros.diffusion.denoiser import Conditioning, Denoiser
from motiondiffuse_ros.diffusion.process import SCHEDULERS, make_scheduler
from motiondiffuse_ros.errors import Cancelled, RequestError, SamplingError

_BATCH_ROWS = 64  # bounds memory on long timelines with many candidates


@dataclass(frozen=True)
class SamplerConfig:
    """How to sample.

    Attributes:
        scheduler: One of `SCHEDULERS`.
        steps: Denoising steps.
        guidance_scale: Classifier-free guidance; 1 is the conditional model alone.
        guidance_interval: Noise levels, as part of the training steps, between which guidance is
            used (Kynkäänniemi et al. 2024); the conditional model alone does the rest.
        eta: Noise re-injected by DDIM, 0 to 1.
        bf16: Evaluate the denoiser under bfloat16 autocast.
    """

    scheduler: str = "ddim"
    steps: int = 30
    guidance_scale: float = 2.5
    guidance_interval: tuple[float, float] = (0.0, 1.0)
    eta: float = 0.0
    bf16: bool = True

    def validate(self) -> None:
        """Raise RequestError if a value is out of range."""
        if self.scheduler not in SCHEDULERS:
            raise RequestError(
                f"unknown scheduler '{self.scheduler}'; the schedulers are {', '.join(SCHEDULERS)}"
            )
        if not 1 <= self.steps <= 1000:
            raise RequestError(f"steps must be from 1 to 1000, got {self.steps}")
        if not 0.0 <= self.eta <= 1.0:
            raise RequestError(f"eta must be from 0 to 1, got {self.eta}")
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
    on_step: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Tensor:
    """Sample normalised features.

    Args:
        denoiser: In evaluation mode.
        windows: Composed timeline; their weights sum to one.
        conditioning: A row for each window.
        unconditional: One row, of the empty text.
        config: Scheduler and guidance.
        frames: Length of the motion.
        candidates: Independent samples.
        seed: Of all noise.
        on_step: Called with (steps done, steps in all).
        cancelled: Asked before each step.

    Returns:
        [candidates, frames, D] float32.

    Raises:
        Cancelled: If `cancelled` said so.
        SamplingError: If the result is not finite.
    """
    config.validate()
    generator = torch.Generator().manual_seed(seed)
    x = torch.randn((candidates, frames, denoiser.config.feature_dim), generator=generator)
    predict = _WindowedPrediction(
        denoiser, windows, conditioning, unconditional, config, candidates
    )
    return _denoise(predict, x, denoiser, config, generator, on_step, cancelled)


@torch.inference_mode()
def sample_batch(
    denoiser: Denoiser,
    lengths: Tensor,
    conditioning: Conditioning,
    unconditional: Conditioning,
    config: SamplerConfig,
    *,
    seed: int,
) -> Tensor:
    """Sample one motion for each of many texts: without composition, of any lengths.

    Args:
        denoiser: In evaluation mode.
        lengths: Frames of each motion [B], at most the denoiser's window.
        conditioning: A row for each text.
        unconditional: One row, of the empty text.
        config: Scheduler and guidance.
        seed: Of all noise.

    Returns:
        Normalised features [B, T, D] float32; the first `lengths` frames of each count.

    Raises:
        SamplingError: If the result is not finite.
    """
    config.validate()
    generator = torch.Generator().manual_seed(seed)
    shape = (len(lengths), int(lengths.max()), denoiser.config.feature_dim)
    x = torch.randn(shape, generator=generator)
    lengths = lengths.to(denoiser.device)
    free = unconditional.expand(torch.zeros(len(lengths), dtype=torch.long))

    def predict(x: Tensor, step: int) -> Tensor:
        return _guided(denoiser, config, x, step, lengths, conditioning, free)

    return _denoise(predict, x, denoiser, config, generator)


def _denoise(
    predict: Callable[[Tensor, int], Tensor],
    x: Tensor,
    denoiser: Denoiser,
    config: SamplerConfig,
    generator: torch.Generator,
    on_step: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Tensor:
    scheduler = make_scheduler(config.scheduler, denoiser.config)
    scheduler.set_timesteps(config.steps)
    x = x.to(denoiser.device)  # drawn on the CPU: a seed means the same on every device
    extra = {"eta": config.eta} if config.scheduler == "ddim" else {}
    total = len(scheduler.timesteps)
    for done, step in enumerate(scheduler.timesteps):
        if cancelled is not None and cancelled():
            raise Cancelled("canceled while sampling")
        output = predict(x, int(step))
        x = scheduler.step(output, step, x, generator=generator, **extra).prev_sample  # type: ignore[arg-type, union-attr]
        if on_step is not None:
            on_step(done + 1, total)
    if not torch.isfinite(x).all():
        raise SamplingError(
            f"sampling gave values that are not finite (seed {generator.initial_seed()}, scheduler "
            f"{config.scheduler}, guidance scale {config.guidance_scale}); lower the guidance scale"
        )
    return x


def _guided(
    denoiser: Denoiser,
    config: SamplerConfig,
    noisy: Tensor,
    step: int,
    lengths: Tensor,
    condition: Conditioning,
    unconditional: Conditioning,
) -> Tensor:
    """Return the prediction under classifier-free guidance."""
    scale = config.guidance_at(step / denoiser.config.train_steps)
    steps = torch.full((len(noisy),), step, device=noisy.device)
    with torch.autocast(noisy.device.type, torch.bfloat16, enabled=config.bf16):
        conditional = denoiser(noisy, steps, lengths, condition)
        if scale == 1.0:
            return conditional
        free = denoiser(noisy, steps, lengths, unconditional)
    return free + scale * (conditional - free)


class _WindowedPrediction:
    """The denoiser's prediction for a whole timeline as the weighted sum over its windows."""

    def __init__(
        self,
        denoiser: Denoiser,
        windows: Sequence[Window],
        conditioning: Conditioning,
        unconditional: Conditioning,
        config: SamplerConfig,
        candidates: int,
    ) -> None:
        self._denoiser, self._windows, self._config = denoiser, windows, config
        self._weights = [
            torch.from_numpy(np.ascontiguousarray(w.weight, dtype=np.float32)).to(denoiser.device)
            for w in windows
        ]
        rows = [(w, c) for w in range(len(windows)) for c in range(candidates)]
        # windows of like length share a batch
        rows.sort(key=lambda row: len(self._weights[row[0]]))
        self._batches = [rows[i : i + _BATCH_ROWS] for i in range(0, len(rows), _BATCH_ROWS)]
        self._conditions = [
            conditioning.expand(torch.tensor([w for w, _ in batch])) for batch in self._batches
        ]
        self._unconditional = [
            unconditional.expand(torch.zeros(len(batch), dtype=torch.long))
            for batch in self._batches
        ]

    def __call__(self, x: Tensor, step: int) -> Tensor:
        out = torch.zeros_like(x)
        for batch, condition, unconditional in zip(
            self._batches, self._conditions, self._unconditional, strict=True
        ):
            lengths = torch.tensor([len(self._weights[w]) for w, _ in batch], device=x.device)
            noisy = x.new_zeros((len(batch), int(lengths.max()), x.shape[2]))
            for row, (w, c) in zip(noisy, batch, strict=True):
                window = self._windows[w]
                row[: len(self._weights[w])] = x[c, window.start : window.stop]
            prediction = _guided(
                self._denoiser, self._config, noisy, step, lengths, condition, unconditional
            )
            for row, (w, c) in zip(prediction, batch, strict=True):
                window, weight = self._windows[w], self._weights[w]
                out[c, window.start : window.stop] += weight * row[: len(weight)]
        return out
