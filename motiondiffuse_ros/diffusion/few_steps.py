"""Weights that take the first, guided steps two at a time, and the sampler they stand for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, fields, replace
from functools import cached_property
from typing import Any

from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import CheckpointError, InputError

_FACTS = ("scheduler", "spacing", "guidance_scale", "guidance_interval")


@dataclass(frozen=True)
class FewStepsOf:
    """What few steps were taught to do; as in `SamplerConfig`, whose other fields stay open.

    Attributes:
        taught: Diffusion steps of the student, falling. Each needs one pass, without guidance.
        then: Those at which the base weights go on, without guidance, falling.
        scheduler: Of the teacher.
        spacing: Of the teacher.
        guidance_scale: Of the teacher; part of what was learnt.
        guidance_interval: Where it was used.
    """

    taught: tuple[int, ...]
    then: tuple[int, ...]
    scheduler: str = SamplerConfig.scheduler
    spacing: float = SamplerConfig.spacing
    guidance_scale: float = SamplerConfig.guidance_scale
    guidance_interval: tuple[float, float] = SamplerConfig.guidance_interval

    @property
    def steps(self) -> int:
        """How many steps there are."""
        return len(self.taught) + len(self.then)

    def validate(self) -> None:
        """Raise InputError if a value is out of range."""
        if not self.taught or not self.then:
            raise InputError("few steps need some that were taught and some of the base weights")
        facts = {name: getattr(self, name) for name in _FACTS}
        self.sampler(SamplerConfig(**facts)).validate()

    def fit(self, config: SamplerConfig) -> bool:
        """Return whether a sampler asks for what they do, in any number of steps."""
        alike = all(getattr(self, name) == getattr(config, name) for name in _FACTS)
        return alike and not config.at

    def sampler(self, config: SamplerConfig) -> SamplerConfig:
        """Return how to sample in these steps."""
        return replace(config, at=(*self.taught, *self.then), guidance_scale=1.0)

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
        tuples = ("taught", "then", "guidance_interval")
        try:
            found = cls(**{**data, **{name: tuple(data[name]) for name in tuples}})
            found.validate()
        except (InputError, TypeError, ValueError) as error:
            raise CheckpointError(f"few steps of a checkpoint, {data!r}: {error}") from error
        return found


@dataclass(frozen=True, eq=False)
class FewSteps:
    """A student and what it was taught (`training.distillation`).

    Attributes:
        load: Makes the denoiser; called once, when it is first asked for.
        stand_for: What its steps do.
        sha256: Hash of the weights file; empty before saving.
    """

    load: Callable[[], Denoiser] = field(repr=False)
    stand_for: FewStepsOf
    sha256: str = ""

    @cached_property
    def denoiser(self) -> Denoiser:
        """In evaluation mode, float32; of the teacher's shape."""
        return self.load()
