"""Weights that need few steps, and the sampler that their steps stand for."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import CheckpointError, InputError


@dataclass(frozen=True)
class FewStepsOf:
    """What few steps were taught to do; as in `SamplerConfig`, whose other fields stay open.

    Attributes:
        at: The diffusion steps that are needed, falling.
        scheduler: Of the teacher.
        spacing: Of both.
        guidance_scale: Of the teacher; part of what was learnt.
        guidance_interval: Where it was used.
    """

    at: tuple[int, ...]
    scheduler: str = SamplerConfig.scheduler
    spacing: float = SamplerConfig.spacing
    guidance_scale: float = SamplerConfig.guidance_scale
    guidance_interval: tuple[float, float] = SamplerConfig.guidance_interval

    @property
    def steps(self) -> int:
        """How many steps are needed."""
        return len(self.at)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: Any) -> FewStepsOf:
        """Build and validate from `to_dict`'s result.

        Raises:
            CheckpointError: If a field is missing, unknown or invalid.
        """
        names = {f.name for f in fields(cls)}
        if not isinstance(data, dict) or set(data) != names:
            raise CheckpointError(f"few steps of a checkpoint need {sorted(names)}, got {data!r}")
        try:
            pair = tuple(data["guidance_interval"])
            found = cls(**{**data, "at": tuple(data["at"]), "guidance_interval": pair})
            SamplerConfig(**found.to_dict()).validate()
        except (InputError, TypeError, ValueError) as error:
            raise CheckpointError(f"few steps of a checkpoint, {data!r}: {error}") from error
        return found


@dataclass(frozen=True, eq=False)
class FewSteps:
    """A student and what it was taught (`training.distillation`).

    Attributes:
        denoiser: In evaluation mode, float32; of the teacher's shape.
        stand_for: What its steps do.
        sha256: Hash of the weights file; empty before saving.
    """

    denoiser: Denoiser = field(repr=False)
    stand_for: FewStepsOf
    sha256: str = ""

    def fit(self, config: SamplerConfig) -> bool:
        """Return whether a sampler asks for what they do, in any number of steps."""
        taught = self.stand_for.to_dict() | {"at": ()}
        return replace(config, **taught) == config

    def sampler(self, config: SamplerConfig) -> SamplerConfig:
        """Return how to sample with them: one pass a step, each of first order."""
        at = self.stand_for.at
        return replace(config, scheduler="ddim", at=at, guidance_scale=1.0)
