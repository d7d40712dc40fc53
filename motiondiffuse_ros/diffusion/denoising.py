"""The denoising loop: some candidates on their way from noise to motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from motiondiffuse_ros.diffusion.constraints import Constraint, apply
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.imagination import Imagination
from motiondiffuse_ros.diffusion.process import (
    from_clean,
    keep_rows,
    make_scheduler,
    to_clean,
)
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import Cancelled, SamplingError

Prediction = Callable[[Tensor, int, Imagination | None], Tensor]
"""From noisy features [C, T, D], step and what windows imagine to the prediction [C, T, D]."""


@dataclass(frozen=True)
class Planting:
    """How feet are held in their places.

    Attributes:
        denoising: In clean predictions, that may still become something else.
        result: In what is returned.
    """

    denoising: Constraint
    result: Constraint


class Denoising:
    """A batch that is denoised step by step, and can wait between two of them.

    Attributes:
        candidates: Names of the rows that are still there.
        done: Steps done.
    """

    def __init__(
        self,
        predict: Prediction,
        noise: Tensor,
        denoiser: Denoiser,
        config: SamplerConfig,
        generator: torch.Generator,
        *,
        first: int = 0,
        constraints: Sequence[Constraint] = (),
        planted: Planting | None = None,
        imagination: Imagination | None = None,
        stepped: Callable[[], None] | None = None,
        cancelled: Callable[[], bool] | None = None,
    ) -> None:
        """Stand before the first step.

        Args:
            predict: The denoiser, of a timeline or of a batch.
            noise: [C, T, D], drawn on the CPU: a seed means the same on every device.
            denoiser: Whose schedule it is.
            config: Scheduler and steps.
            generator: Of noise that the scheduler adds.
            first: Name of the first row; the others count on from it.
            constraints: What the motion must keep to, met at every step and in the result.
            planted: What is imposed below `planted_below`, before the constraints.
            imagination: Of this batch's windows, where they are denoised apart at first.
            stepped: Called after each step.
            cancelled: Asked before each step.
        """
        self._predict, self._config, self._generator = predict, config, generator
        self._kind, self._train_steps = denoiser.config.prediction_type, denoiser.config.train_steps
        self._constraints, self._planted = constraints, planted
        self._imagination = imagination
        self._stepped, self._cancelled = stepped, cancelled
        self._scheduler = make_scheduler(config.scheduler, denoiser.config)
        self._scheduler.set_timesteps(timesteps=config.times(self._train_steps))
        self._steps = [int(step) for step in self._scheduler.timesteps]
        self._x = noise.to(denoiser.device)
        self._output: Tensor | None = None
        self.candidates = tuple(range(first, first + len(noise)))
        self.done = 0

    def reach(self, noise: float) -> bool:
        """Go on until something is predicted at a noise level below this one.

        Returns:
            Whether there was a step below it; all are done if not.
        """
        for step in self._steps[self.done :]:
            self._look(step)
            if step / self._train_steps < noise:
                return True
            self._step(step)
        return False

    @property
    def expected(self) -> Tensor:
        """What the rows are predicted to become [C, T, D], where `reach` stopped."""
        assert self._output is not None
        return to_clean(self._kind, self._output, self._x, self._alpha(self._steps[self.done]))

    def keep(self, rows: Sequence[int]) -> None:
        """Go on with some rows, where `reach` stopped."""
        assert self._output is not None
        rows = list(rows)
        self._x, self._output = self._x[rows], self._output[rows]
        self.candidates = tuple(self.candidates[row] for row in rows)
        keep_rows(self._scheduler, rows)
        if self._imagination is not None:
            self._imagination.keep(rows)

    def finish(self) -> Tensor:
        """Do the steps that are left and return the motions [C, T, D]. To be called once.

        Raises:
            Cancelled: If `cancelled` said so.
            SamplingError: If they are not finite.
        """
        self.reach(0.0)
        x = self._x
        if self._planted is not None and self._config.planted_below > 0.0:
            x = self._planted.result(x)
        x = apply(self._constraints, x)
        if not torch.isfinite(x).all():
            raise SamplingError(
                f"sampling gave values that are not finite (seed {self._generator.initial_seed()}, "
                f"scheduler {self._config.scheduler}, guidance scale "
                f"{self._config.guidance_scale}); lower the guidance scale"
            )
        return x

    def _alpha(self, step: int) -> Tensor:
        return self._scheduler.alphas_cumprod[step].to(self._x)

    def _look(self, step: int) -> None:
        """Predict, if that is not done."""
        if self._output is None:
            if self._cancelled is not None and self._cancelled():
                raise Cancelled("canceled while sampling")
            self._output = self._predict(self._x, step, self._imagination)

    def _step(self, step: int) -> None:
        x, output, alpha = self._x, self._output, self._alpha(step)
        assert output is not None
        imposed = self._constraints
        if self._planted is not None and step / self._train_steps < self._config.planted_below:
            imposed = (self._planted.denoising, *imposed)
        if imposed:
            clean = apply(imposed, to_clean(self._kind, output, x, alpha))
            output = from_clean(self._kind, clean, x, alpha)
        moved = self._scheduler.step(output, step, x, generator=self._generator)  # type: ignore[arg-type]
        self._x, self._output = moved.prev_sample, None  # type: ignore[union-attr]
        self.done += 1
        if self._stepped is not None:
            self._stepped()
