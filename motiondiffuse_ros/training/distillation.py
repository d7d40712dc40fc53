"""Distillation: a student learns to go in one step where its teacher goes in two guided ones."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import torch
from torch import Tensor

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.few_steps import FewSteps, FewStepsOf
from motiondiffuse_ros.diffusion.guidance import GuidedDenoiser
from motiondiffuse_ros.diffusion.precision import use_bf16
from motiondiffuse_ros.diffusion.process import make_scheduler, to_clean
from motiondiffuse_ros.diffusion.sampler import centred_noise
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.text import TextEncoder
from motiondiffuse_ros.training.checks import check_representation
from motiondiffuse_ros.training.distill_config import DistillConfig
from motiondiffuse_ros.training.losses import Losses, MotionLoss
from motiondiffuse_ros.training.optimisation import (
    averaged,
    learning_rate,
    make_average,
    make_optimizer,
)
from motiondiffuse_ros.training.texts import CaptionStates, all_captions, other_words_of
from motiondiffuse_ros.training.windows import WindowBatch, WindowSampler

CHECKPOINT_FOLDER = "checkpoint"
CARD_FILE = "few_steps.json"
_VALIDATION_BATCHES = 4
_VALIDATION_SEED = 1234


class Jump(NamedTuple):
    """What the student does in one step and its teacher in two.

    Attributes:
        start: Diffusion step from which both go.
        middle: The teacher's second.
        end: Where both arrive.
    """

    start: int
    middle: int
    end: int


def jumps(times: Sequence[int], pairs: int) -> list[Jump]:
    """Return the student's steps.

    Args:
        times: The teacher's diffusion steps, falling.
        pairs: How many steps the student has; the teacher has more than twice as many.
    """
    return [Jump(*times[i : i + 3]) for i in range(0, 2 * pairs, 2)]


class Levels:
    """A noise schedule, as signal and noise at its steps."""

    def __init__(self, alphas_cumprod: Tensor) -> None:
        self._alphas = alphas_cumprod.double().tolist()

    def __call__(self, step: int) -> tuple[float, float]:
        """Return the shares of signal and of noise."""
        return math.sqrt(self._alphas[step]), math.sqrt(1.0 - self._alphas[step])

    def moved(self, x: Tensor, clean: Tensor, start: int, end: int) -> Tensor:
        """Return where a step of first order goes (DDIM, Song et al. 2021).

        Args:
            x: Noisy features at `start`.
            clean: What they are predicted to become.
            start: Diffusion step.
            end: The next one.
        """
        keep, add = self._parts(start, end)
        return keep * x + add * clean

    def aim(self, x: Tensor, moved: Tensor, start: int, end: int) -> Tensor:
        """Return what must be predicted for a step of first order to arrive at `moved`."""
        keep, add = self._parts(start, end)
        return (moved - keep * x) / add

    def _parts(self, start: int, end: int) -> tuple[float, float]:
        (signal, noise), (signal_end, noise_end) = self(start), self(end)
        keep = noise_end / noise
        return keep, signal_end - keep * signal

    def lead(self, jump: Jump) -> float:
        """Return how far the second of two steps goes on in the direction of their predictions.

        DPM-Solver++ of second order (Lu et al. 2022, algorithm 2).
        """
        first, second, third = (math.log(s / n) for s, n in map(self, jump))
        return (third - second) / (2.0 * (second - first))


@dataclass(frozen=True)
class DistillProgress:
    """Where a run stands.

    Attributes:
        step: Optimiser steps done.
        minutes: Time so far.
        loss: Running mean of the loss on features.
        validation: Last squared error on held-out texts, averaged over steps.
    """

    step: int
    minutes: float
    loss: float
    validation: float


class Distiller:
    """Teaches a student the teacher's guided steps, two at a time (Salimans and Ho 2022).

    Guidance is learnt with them (Meng et al. 2023), so that the student needs one pass a step. It
    starts from noise and goes on from where its own steps lead, and at each of them is taught where
    the teacher would have gone from there.

    Writes under `out`: checkpoint/ (averaged weights beside the teacher's, in few_steps.json how
    they came about) and log.jsonl.

    Attributes:
        student: What is trained.
    """

    def __init__(
        self,
        corpus: Corpus,
        encoder: TextEncoder,
        teacher: Checkpoint,
        config: DistillConfig,
        out: Path,
        *,
        student: FewSteps | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare.

        Args:
            corpus: Whose texts and lengths are asked for.
            encoder: The teacher's.
            teacher: Weights to learn from.
            config: Of the run.
            out: Folder of the run.
            student: Of which to start; the teacher's weights if None.
            clock: Of the run's time [s].

        Raises:
            InputError: If the settings do not fit together.
            CheckpointError: If the corpus does not speak the teacher's representation.
        """
        config.validate()
        check_representation(corpus, teacher.denoiser.config)
        self._sampler = SamplerConfig(steps=config.teacher_steps)
        self._config, self._out, self._clock = config, out, clock
        self._teacher, self._stopping = teacher, False
        start = teacher if student is None else student
        shape = teacher.denoiser.config
        self._jumps = jumps(self._sampler.times(shape.train_steps), config.pairs)
        if self._jumps[-1].end != config.then[0]:
            raise InputError(
                f"distilling then must begin at {self._jumps[-1].end}, where the student arrives, "
                f"got {config.then}"
            )
        self._levels = Levels(make_scheduler("ddpm", shape).alphas_cumprod)
        self.student = deepcopy(start.denoiser).train()
        self._optimizer = make_optimizer(
            self.student, learning_rate=config.learning_rate, weight_decay=config.weight_decay
        )
        self._ema = make_average(self.student, config.ema_decay)
        self._bf16 = use_bf16(config.precision)
        self._loss = MotionLoss(corpus.representation, corpus.statistics, corpus.fps)
        self._step, self._seconds = 0, 0.0
        self._apart: dict[str, Any] = {}
        train, val = corpus.split("train"), corpus.split("val")
        windows = WindowSampler(
            corpus,
            train,
            max_frames=shape.max_frames,
            mirror=0.5,
            other_words=other_words_of,
            statements=config.statements,
            deeds=config.deeds,
            crop=0.5,
            seed=config.seed,
        )
        held_out = WindowSampler(
            corpus, val, max_frames=shape.max_frames, mirror=0.5, crop=0.5, seed=_VALIDATION_SEED
        )
        texts = all_captions((*train, *val), windows.stated_texts())
        self._captions = CaptionStates(texts, encoder)
        self._windows = windows.batches(config.batch_size)
        batches = held_out.batches(config.batch_size)
        self._validation = [next(batches) for _ in range(_VALIDATION_BATCHES)]
        torch.manual_seed(config.seed)  # the same noise whatever was drawn before
        out.mkdir(parents=True, exist_ok=True)
        self._settings = {
            "distilling": config.to_dict(),
            "sampler": asdict(self._sampler),
            "teacher": teacher.sha256,
            "started_from": start.sha256,
        }

    def stop(self) -> None:
        """Ask for the end of `run` after the present step, also from a signal handler."""
        self._stopping = True

    def run(self, on_progress: Callable[[DistillProgress], None] | None = None) -> None:
        """Teach until `minutes` are used up or `stop` is called, saving on the way and then."""
        config = self._config
        mean_loss, saved, began = 0.0, 0.0, self._clock()
        validation = self._validate()
        while not self._stopping and self._seconds < 60.0 * config.minutes:
            by_jump = self._train_step(next(self._windows))
            self._step += 1
            loss = sum(losses.features.item() for losses in by_jump) / len(by_jump)
            mean_loss = loss if mean_loss == 0.0 else 0.98 * mean_loss + 0.02 * loss
            self._seconds = self._clock() - began
            if self._step % 10 == 0:
                self._append_log(
                    {"plain": [losses.plain.item() for losses in by_jump], "features": loss}
                )
            if self._step % config.validate_steps == 0:
                validation = self._validate()
            if self._seconds - saved > 60.0 * config.save_minutes:
                self.save()
                saved = self._seconds
            if on_progress is not None:
                on_progress(
                    DistillProgress(self._step, self._seconds / 60.0, mean_loss, validation)
                )
        self._validate()
        self.save()

    def save(self) -> None:
        """Write the averaged weights beside the teacher's, and how they came about."""
        folder = self._out / CHECKPOINT_FOLDER
        with averaged(self.student, self._ema):
            few = FewSteps(
                lambda: self.student,
                FewStepsOf(tuple(jump.start for jump in self._jumps), self._config.then),
            )
            replace(self._teacher, few_steps=few).save_pretrained(folder)
        motions = self._step * self._config.batch_size
        card = {**self._settings, **self._row(), "motions": motions, **self._apart}
        (folder / CARD_FILE).write_text(json.dumps(card, indent=2) + "\n")

    def _train_step(self, batch: WindowBatch) -> list[Losses]:
        config = self._config
        for group in self._optimizer.param_groups:
            group["lr"] = learning_rate(
                config.learning_rate,
                step=self._step,
                warmup_steps=config.warmup_steps,
                done=self._seconds / (60.0 * config.minutes),
            )
        total, by_jump = self._taught(batch, centred_noise(batch.features.shape, None))
        self._optimizer.zero_grad(set_to_none=True)
        (total / len(by_jump)).backward()
        torch.nn.utils.clip_grad_norm_(self.student.parameters(), config.gradient_clip)
        self._optimizer.step()
        self._ema.step(self.student.parameters())
        return by_jump

    def _taught(self, batch: WindowBatch, x: Tensor) -> tuple[Tensor, list[Losses]]:
        """Return the loss over the student's steps from noise `x`, and its terms."""
        config = self._config
        tokens = self._captions.batch(batch.texts)
        lengths = torch.full((len(x),), x.shape[1])
        guided = self._guided(batch.texts)
        with torch.autocast("cpu", torch.bfloat16, enabled=self._bf16):
            conditioning = self.student.condition(tokens.states, tokens.mask)
        total, by_jump = torch.zeros(()), []
        for jump in self._jumps:
            aim = self._aim(guided, x, jump)
            steps = torch.full_like(lengths, jump.start)
            with torch.autocast("cpu", torch.bfloat16, enabled=self._bf16):
                output = self.student(x, steps, lengths, conditioning)
            clean = self._clean(output, x, jump.start)
            losses = self._loss(clean, aim, lengths, self._step, torch.ones(len(x)))
            by_jump.append(losses)
            total = total + losses.weighed(config)
            x = self._levels.moved(x, clean.detach(), jump.start, jump.end)
        return total, by_jump

    @torch.no_grad()
    def _aim(self, guided: GuidedDenoiser, x: Tensor, jump: Jump) -> Tensor:
        """Return what the student must predict [B, T, D] to arrive where the teacher does."""
        lengths, rows = torch.full((len(x),), x.shape[1]), torch.arange(len(x))

        def predicted(x: Tensor, step: int) -> Tensor:
            return self._clean(guided(x, step, lengths, rows), x, step)

        first = predicted(x, jump.start)
        at_middle = self._levels.moved(x, first, jump.start, jump.middle)
        second = predicted(at_middle, jump.middle)
        second = second + self._levels.lead(jump) * (second - first)
        arrived = self._levels.moved(at_middle, second, jump.middle, jump.end)
        return self._levels.aim(x, arrived, jump.start, jump.end)

    def _clean(self, output: Tensor, x: Tensor, step: int) -> Tensor:
        signal, _ = self._levels(step)
        kind = self._teacher.denoiser.config.prediction_type
        return to_clean(kind, output, x, torch.tensor(signal**2))

    @torch.no_grad()
    def _guided(self, texts: Sequence[str]) -> GuidedDenoiser:
        denoiser = self._teacher.denoiser
        tokens = self._captions.batch([*texts, ""])
        every = denoiser.condition(tokens.states, tokens.mask)
        train_steps = denoiser.config.train_steps
        return GuidedDenoiser(
            denoiser,
            every.expand(torch.arange(len(texts))),
            every.expand(torch.tensor([len(texts)])),
            self._sampler.times(train_steps),
            lambda step: self._sampler.guidance_at(step / train_steps),
            bf16=self._bf16,
        )

    @torch.no_grad()
    def _validate(self) -> float:
        """Return the averaged student's squared error on held-out texts, over its steps."""
        generator = torch.Generator().manual_seed(_VALIDATION_SEED)
        by_jump = []
        with averaged(self.student, self._ema):
            for batch in self._validation:
                noise = centred_noise(batch.features.shape, generator)
                _, losses = self._taught(batch, noise)
                by_jump.append([each.plain.item() for each in losses])
        means = torch.tensor(by_jump).mean(0)
        self._apart = {"validation": means.mean().item(), "validation_by_step": means.tolist()}
        self._append_log(self._apart)
        return self._apart["validation"]

    def _append_log(self, values: dict[str, Any]) -> None:
        with (self._out / "log.jsonl").open("a", encoding="utf-8") as file:
            file.write(json.dumps({**self._row(), **values}) + "\n")

    def _row(self) -> dict[str, float]:
        return {"step": self._step, "minutes": self._seconds / 60.0}
