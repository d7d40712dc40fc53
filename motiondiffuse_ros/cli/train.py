"""`motiondiffuse train`: train a denoiser on a corpus."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.training.config import TrainConfig


@dataclass(frozen=True)
class Train:
    """Train a denoiser; stop at any time and go on with --resume.

    Under torchrun several processes train together (docs/training.md).

    Leaves in the output folder: checkpoint/ (to generate with), training_state.pt (to resume),
    config.json, log.jsonl and TensorBoard events (tensorboard --logdir OUT).
    """

    corpus: Path = Path("corpus")
    """Corpus folder made by `motiondiffuse corpus build`."""
    out: Path = Path("runs/base")
    """Folder of the run."""
    resume: bool = False
    """Go on with the run in the folder."""
    start: Path | None = None
    """Checkpoint folder to start from instead of random weights (fine-tuning)."""
    paper: bool = False
    """The paper's architecture (needs --text-encoder) instead of the default one."""
    text_encoder: Path | None = None
    """Folder of CLIP's files, for --paper."""
    critic: Path | None = None
    """Evaluator whose text space the text layers are drawn to (see docs/training.md)."""
    layers: int = DenoiserConfig.layers
    """Decoder layers."""
    width: int = DenoiserConfig.width
    """Width of the motion tokens."""
    patch_size: int = DenoiserConfig.patch_size
    """Frames a token."""
    prediction_type: str = DenoiserConfig.prediction_type
    """sample, epsilon or v_prediction."""
    training: TrainConfig = field(default_factory=TrainConfig)


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    options = parse(Train, arguments, "train")
    options.training.validate()
    if options.paper and options.text_encoder is None:
        raise InputError("--paper uses CLIP: give the folder of its files as --text-encoder")
    denoiser = (
        DenoiserConfig.paper()
        if options.paper
        else DenoiserConfig(
            layers=options.layers,
            width=options.width,
            patch_size=options.patch_size,
            prediction_type=options.prediction_type,
        )
    )
    denoiser.validate()
    from motiondiffuse_ros.corpus.store import Corpus
    from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
    from motiondiffuse_ros.evaluation.evaluator import Evaluator
    from motiondiffuse_ros.memory import keep_freed_memory
    from motiondiffuse_ros.text import load_text_encoder
    from motiondiffuse_ros.training.ranks import joined
    from motiondiffuse_ros.training.trainer import Trainer, TrainProgress

    keep_freed_memory()
    corpus = Corpus.load(options.corpus)
    encoder = load_text_encoder(denoiser.text_encoder, options.text_encoder)
    critic = (
        None
        if options.critic is None
        else Evaluator.from_pretrained(options.critic, load_text_encoder("minilm"))
    )
    with joined() as ranks:
        console = Console(quiet=not ranks.first)
        columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        with Progress(*columns, console=console, disable=not ranks.first) as bar:
            captions = bar.add_task("captions", total=None)
            trainer = Trainer(
                corpus,
                encoder,
                denoiser,
                options.training,
                options.out,
                resume=options.resume,
                start=None if options.start is None else Checkpoint.from_pretrained(options.start),
                critic=critic,
                ranks=ranks,
                on_captions=lambda done, total: bar.update(captions, completed=done, total=total),
            )
            task = bar.add_task("training", total=options.training.minutes)

            def show(p: TrainProgress) -> None:
                validation = "" if p.validation is None else f", validation {p.validation:.3f}"
                bar.update(
                    task,
                    completed=p.minutes,
                    description=f"step {p.step}, loss {p.loss:.3f}{validation}, "
                    f"{p.windows_per_second:.0f} windows/s",
                )

            # the shell lets background jobs ignore SIGINT; both stop the run after its step
            for stop in (signal.SIGINT, signal.SIGTERM):
                signal.signal(stop, lambda *_: trainer.stop())
            trainer.run(show)
        console.print(f"written to {options.out}")
    return 0
