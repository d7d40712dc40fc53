"""How to sample."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from motiondiffuse_ros.diffusion.precision import check_precision
from motiondiffuse_ros.diffusion.process import SCHEDULERS, denoising_steps
from motiondiffuse_ros.errors import RequestError

_FRACTIONS = (
    "part_correction",
    "time_correction",
    "apart_above",
    "planted_below",
    "thinned_below",
)


@dataclass(frozen=True)
class SamplerConfig:
    """How to sample.

    Attributes:
        scheduler: One of `SCHEDULERS`.
        steps: Denoising steps.
        spacing: How much denser they are where there is more noise; see `denoising_steps`.
        at: The diffusion steps themselves, falling, instead of `steps` and `spacing`.
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
    at: tuple[int, ...] = ()
    guidance_scale: float = 4.0
    guidance_interval: tuple[float, float] = (0.8, 1.0)
    part_correction: float = 0.0
    time_correction: float = 0.5
    apart_above: float = 0.0
    planted_below: float = 0.5
    thinned_below: float = 0.97
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
        if any(a <= b for a, b in pairwise((*self.at, -1))):
            raise RequestError(f"at must be falling diffusion steps, got {self.at}")
        for name in _FRACTIONS:
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise RequestError(f"{name} must be from 0 to 1, got {getattr(self, name)}")
        low, high = self.guidance_interval
        if not 0.0 <= low < high <= 1.0:
            raise RequestError(
                f"guidance_interval must be two rising numbers from 0 to 1, got {low}, {high}"
            )

    def times(self, train_steps: int) -> list[int]:
        """Return the diffusion steps, from the noisiest on.

        Args:
            train_steps: Of the denoiser.
        """
        return list(self.at) or denoising_steps(self.steps, self.spacing, train_steps)

    def guidance_at(self, noise: float) -> float:
        """Return the guidance scale at a noise level, 0 (clean) to 1."""
        low, high = self.guidance_interval
        return self.guidance_scale if low <= noise <= high else 1.0
