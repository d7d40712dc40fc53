"""The training loop."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import torch
from diffusers.schedulers.scheduling_ddpm import DDPMScheduler
from torch import Tensor, nn
from torch.utils.tensorboard import SummaryWriter

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.precision import use_bf16
from motiondiffuse_ros.diffusion.process import make_scheduler, to_clean
from motiondiffuse_ros.errors import Cancelled, CheckpointError
from motiondiffuse_ros.evaluation.evaluator import CRITIC_FOLDER, Evaluator
from motiondiffuse_ros.text import TextEncoder
from motiondiffuse_ros.training.alignment import TextAlignment
from motiondiffuse_ros.training.checks import check_representation
from motiondiffuse_ros.training.config import TrainConfig
from motiondiffuse_ros.training.losses import Losses, MotionLoss
from motiondiffuse_ros.training.noise_levels import draw_steps, noise_weight
from motiondiffuse_ros.training.optimisation import (
    averaged,
    learning_rate,
    make_average,
    make_optimizer,
)
from motiondiffuse_ros.training.ranks import ALONE, Ranks
from motiondiffuse_ros.training.text_to_prediction import TextToPrediction
from motiondiffuse_ros.training.texts import CaptionStates, all_captions, other_words_of
from motiondiffuse_ros.training.windows import WindowBatch, WindowSampler

STATE_FILE = "training_state.pt"
CHECKPOINT_FOLDER = "checkpoint"
_VALIDATION_BATCHES = 8
_VALIDATION_SEED = 1234


@dataclass(frozen=True)
class TrainProgress:
    """Where a run stands.

    Attributes:
        step: Optimiser steps done.
        minutes: Training time so far, over all pieces.
        loss: Running mean of the training loss.
        validation: Last validation loss (unweighted), None before the first.
        windows_per_second: Speed of late, of all processes.
    """

    step: int
    minutes: float
    loss: float
    validation: float | None
    windows_per_second: float


class Trainer:
    """Trains a denoiser on a corpus; can be stopped at any time and resumed.

    Writes under `out`: checkpoint/ (averaged weights and the critic, as shipped),
    training_state.pt (to resume), config.json, log.jsonl and TensorBoard events. Of processes that
    train together the first does so, on its own windows' losses.

    Attributes:
        denoiser: What is trained.
    """

    def __init__(
        self,
        corpus: Corpus,
        encoder: TextEncoder,
        denoiser_config: DenoiserConfig,
        config: TrainConfig,
        out: Path,
        *,
        resume: bool = False,
        start: Checkpoint | None = None,
        critic: Evaluator | None = None,
        ranks: Ranks = ALONE,
        on_captions: Callable[[int, int], None] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        config.validate()
        check_representation(corpus, denoiser_config)
        self._corpus, self._encoder, self._config, self._out = corpus, encoder, config, out
        self._ranks, self._clock, self._stopping = ranks, clock, False
        torch.manual_seed(config.seed)
        self.denoiser = Denoiser(denoiser_config).to(ranks.device)
        self._model = TextToPrediction(self.denoiser)
        self._started_from = None if start is None else start.sha256
        if start is not None:
            self._start_from(start)
        self._optimizer = make_optimizer(
            self.denoiser, learning_rate=config.learning_rate, weight_decay=config.weight_decay
        )
        self._ema = make_average(self.denoiser, config.ema_decay)
        scheduler = make_scheduler("ddpm", denoiser_config)
        assert isinstance(scheduler, DDPMScheduler)
        self._scheduler = scheduler
        self._loss = MotionLoss(corpus.representation, corpus.statistics, corpus.fps)
        self._bf16 = use_bf16(config.precision, ranks.device)
        self._step, self._seconds = 0, 0.0
        out.mkdir(parents=True, exist_ok=True)
        if resume:
            self._load_state()
        elif (out / STATE_FILE).exists():
            raise CheckpointError(
                f"{out} holds a run already; add --resume or choose another --out"
            )
        train, val = corpus.split("train"), corpus.split("val")
        settings = {
            "max_frames": denoiser_config.max_frames,
            "mirror": config.mirror,
            "other_words": other_words_of,
        }
        windows = WindowSampler(
            corpus,
            train,
            statements=config.statements,
            deeds=config.deeds,
            crop=config.crop,
            seed=ranks.seed(config.seed + self._step),
            **settings,
        )
        texts = all_captions((*train, *val), windows.stated_texts())
        self._captions = CaptionStates(texts, encoder, on_captions)
        self._critic = critic
        self._alignment = (
            None if critic is None else TextAlignment(critic, texts, denoiser_config.time_width)
        )
        self._windows = windows.batches(config.batch_size)
        held_out = WindowSampler(corpus, val, statements=0.0, seed=_VALIDATION_SEED, **settings)
        batches = held_out.batches(config.batch_size)
        self._validation = [next(batches) for _ in range(_VALIDATION_BATCHES)]
        self._together = ranks.together(self._model)
        if ranks.first:
            self._record_settings()
        else:  # the first goes on from the draws of its weights
            torch.manual_seed(ranks.seed(config.seed + self._step))

    def stop(self) -> None:
        """Ask for the end of `run` after the present step, also from a signal handler."""
        self._stopping = True

    def run(self, on_progress: Callable[[TrainProgress], None] | None = None) -> None:
        """Train until `minutes` are used up; saves on the way and at the end, also when stopped.

        Args:
            on_progress: Told of every step, in the first process.

        Raises:
            Cancelled: After saving, if `stop` was called in any process.
        """
        config = self._config
        writer = SummaryWriter(str(self._out)) if self._ranks.first else None
        stopping = False
        validation: float | None = None
        mean_loss, saved, began = 0.0, self._seconds, self._clock()
        before = self._seconds
        rate, lap = 0.0, self._clock()
        try:
            while not stopping and self._seconds < 60.0 * config.minutes:
                losses, alignment = self._train_step(next(self._windows))
                self._step += 1
                total = losses.features.item()
                mean_loss = total if mean_loss == 0.0 else 0.98 * mean_loss + 0.02 * total
                now = self._clock()
                speed = config.batch_size * self._ranks.size / (now - lap)
                rate, lap = (speed if rate == 0.0 else 0.95 * rate + 0.05 * speed), now
                elapsed = before + now - began
                self._seconds, stopping = self._ranks.agree(elapsed, self._stopping)
                if writer is None:
                    continue
                if self._step % 20 == 0:
                    self._log(writer, losses, alignment, rate)
                if self._step % config.validate_steps == 0:
                    validation = self.validate()
                    writer.add_scalar("validation/plain", validation, self._step)
                    self._append_log({"validation": validation})
                    lap = self._clock()
                if self._seconds - saved > 60.0 * config.save_minutes:
                    self.save()
                    saved = self._seconds
                if on_progress is not None:
                    on_progress(
                        TrainProgress(self._step, self._seconds / 60.0, mean_loss, validation, rate)
                    )
        finally:
            if writer is not None:
                self.save()
                writer.close()
        self._ranks.wait()  # for the files
        if stopping:
            raise Cancelled(f"stopped after {self._step} steps; go on with --resume")

    @torch.no_grad()
    def validate(self) -> float:
        """Return the averaged weights' unweighted loss on fixed held-out windows and noise."""
        generator = torch.Generator().manual_seed(_VALIDATION_SEED)
        with averaged(self.denoiser, self._ema):
            losses = [self._forward(self._model, b, generator, 0.0)[0] for b in self._validation]
        return sum(loss.plain.item() for loss in losses) / len(losses)

    def save(self) -> None:
        """Write the averaged weights and the state to resume from."""
        with averaged(self.denoiser, self._ema):
            Checkpoint(
                self.denoiser, self._corpus.statistics, self._encoder.sha256
            ).save_pretrained(self._out / CHECKPOINT_FOLDER)
        if self._critic is not None:
            self._critic.save_pretrained(self._out / CHECKPOINT_FOLDER / CRITIC_FOLDER)
        state = {
            "denoiser_config": self.denoiser.config.to_dict(),
            "denoiser": self.denoiser.state_dict(),
            "optimizer": self._optimizer.state_dict(),
            "ema": self._ema.state_dict(),
            "started_from": self._started_from,
            "step": self._step,
            "seconds": self._seconds,
        }
        partial = self._out / f"{STATE_FILE}.partial"
        torch.save(state, partial)
        partial.replace(self._out / STATE_FILE)  # a stop while writing leaves the last one whole

    def _train_step(self, batch: WindowBatch) -> tuple[Losses, Tensor]:
        for group in self._optimizer.param_groups:
            group["lr"] = self._learning_rate()
        dropout = self._config.condition_dropout
        losses, alignment = self._forward(self._together, batch, None, dropout)
        total = losses.weighed(self._config) + self._config.alignment_weight * alignment
        self._optimizer.zero_grad(set_to_none=True)
        total.backward()
        torch.nn.utils.clip_grad_norm_(self.denoiser.parameters(), self._config.gradient_clip)
        self._optimizer.step()
        self._ema.step(self.denoiser.parameters())
        return losses, alignment

    def _forward(
        self,
        model: nn.Module,
        batch: WindowBatch,
        generator: torch.Generator | None,
        dropout: float,
    ) -> tuple[Losses, Tensor]:
        clean = batch.features
        noise = torch.randn(clean.shape, generator=generator)
        # validation, which brings its generator, is over all steps alike
        noisiest = self._config.noisiest if generator is None else 0.0
        steps = draw_steps(self.denoiser.config.train_steps, len(clean), noisiest, generator)
        drop = torch.rand(len(clean), generator=generator) < dropout
        texts = ["" if d else text for d, text in zip(drop.tolist(), batch.texts, strict=True)]
        tokens = self._captions.batch(texts)
        noisy = self._scheduler.add_noise(clean, noise, steps)  # type: ignore[arg-type]
        with torch.autocast(self._ranks.device.type, torch.bfloat16, enabled=self._bf16):
            output, pooled = model(tokens, noisy, steps, batch.lengths)
        alpha = self._scheduler.alphas_cumprod[steps]
        kind = self.denoiser.config.prediction_type
        predicted = to_clean(kind, output, noisy, alpha[:, None, None])
        weight = noise_weight(alpha, self._config.snr_limit)
        losses = self._loss(predicted, clean, batch.lengths, self._step, weight)
        if self._alignment is None:
            return losses, torch.zeros(())
        return losses, self._alignment(pooled, texts)

    def _learning_rate(self) -> float:
        return learning_rate(
            self._config.learning_rate,
            step=self._step,
            warmup_steps=self._config.warmup_steps,
            done=self._seconds / (60.0 * self._config.minutes),
        )

    def _start_from(self, start: Checkpoint) -> None:
        theirs, ours = start.denoiser.config, self.denoiser.config
        if replace(theirs, end_positions=ours.end_positions) != ours or (
            theirs.end_positions and not ours.end_positions
        ):
            differing = [k for k, v in theirs.to_dict().items() if ours.to_dict()[k] != v]
            raise CheckpointError(
                f"the weights to start from differ from this denoiser in {', '.join(differing)}"
            )
        if start.text_encoder_sha256 != self._encoder.sha256:
            raise CheckpointError(
                "the weights to start from were trained with another text encoder"
            )
        # end positions that they lack stay zero: they say nothing yet
        self.denoiser.load_state_dict(
            start.denoiser.state_dict(), strict=theirs.end_positions == ours.end_positions
        )

    def _load_state(self) -> None:
        path = self._out / STATE_FILE
        try:
            state = torch.load(path, weights_only=True, map_location="cpu")
        except FileNotFoundError as error:
            raise CheckpointError(f"nothing to resume: {path} does not exist") from error
        except Exception as error:  # torch.load raises many kinds for a truncated file
            raise CheckpointError(f"{path}: cannot be resumed from ({error})") from error
        if state["denoiser_config"] != self.denoiser.config.to_dict():
            raise CheckpointError(f"{path}: was trained with another denoiser configuration")
        self.denoiser.load_state_dict(state["denoiser"])
        self._optimizer.load_state_dict(state["optimizer"])
        self._ema.load_state_dict(state["ema"])
        self._ema.to(self._ranks.device)
        self._step, self._seconds = state["step"], state["seconds"]
        self._started_from = state.get("started_from")
        torch.manual_seed(self._config.seed + self._step)

    def _record_settings(self) -> None:
        settings = {
            "training": self._config.to_dict(),
            "denoiser": self.denoiser.config.to_dict(),
            "parameters": sum(p.numel() for p in self.denoiser.parameters()),
            "started_from": self._started_from,
            "processes": self._ranks.size,
            "train_clips": len(self._corpus.split("train")),
        }
        (self._out / "config.json").write_text(json.dumps(settings, indent=2) + "\n")

    def _log(self, writer: SummaryWriter, losses: Losses, alignment: Tensor, rate: float) -> None:
        values = {name: value.item() for name, value in vars(losses).items()}
        values["alignment"] = alignment.item()
        for name, value in values.items():
            writer.add_scalar(f"training/{name}", value, self._step)
        writer.add_scalar("training/windows_per_second", rate, self._step)
        self._append_log({**values, "learning_rate": self._learning_rate(), "rate": rate})

    def _append_log(self, values: dict[str, float]) -> None:
        row = {"step": self._step, "minutes": self._seconds / 60.0, **values}
        with (self._out / "log.jsonl").open("a", encoding="utf-8") as file:
            file.write(json.dumps({k: round(v, 6) for k, v in row.items()}) + "\n")
