"""`motiondiffuse train-evaluator`: train the ruler that `motiondiffuse evaluate` measures with."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.errors import CheckpointError
from motiondiffuse_ros.evaluation.config import EvaluatorConfig, EvaluatorTraining


@dataclass(frozen=True)
class TrainEvaluator:
    """Train the text-motion evaluator and the action recogniser on a corpus's training split.

    Leaves in the output folder: the weights, config.json with their hashes, and training.json.
    """

    corpus: Path = Path("corpus")
    """Corpus folder made by `motiondiffuse corpus build`."""
    out: Path = Path("runs/evaluator")
    """Folder for the evaluator."""
    start: Path | None = None
    """Folder of an evaluator to go on from; its recogniser is kept as it is."""
    training: EvaluatorTraining = field(default_factory=EvaluatorTraining)


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    options = parse(TrainEvaluator, arguments, "train-evaluator")
    options.training.validate()
    if options.out.exists() and any(options.out.iterdir()):
        raise CheckpointError(f"{options.out} is not empty; choose another --out")
    from motiondiffuse_ros.corpus.store import Corpus
    from motiondiffuse_ros.evaluation.evaluator import Evaluator
    from motiondiffuse_ros.evaluation.training import train_evaluator
    from motiondiffuse_ros.text import load_text_encoder

    corpus = Corpus.load(options.corpus)
    encoder = load_text_encoder("minilm")
    start = None if options.start is None else Evaluator.from_pretrained(options.start, encoder)
    console = Console()
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    losses: dict[str, float] = {}
    with Progress(*columns, console=console) as bar:
        tasks = {}

        def show(what: str, done: float, loss: float) -> None:
            if what not in tasks:
                tasks[what] = bar.add_task(what, total=1.0)
            losses[what] = loss
            bar.update(tasks[what], completed=done, description=f"{what}, loss {loss:.3f}")

        evaluator = train_evaluator(
            corpus,
            encoder,
            start or EvaluatorConfig(feature_dim=corpus.representation.dim),
            options.training,
            show,
        )
    evaluator.save_pretrained(options.out)
    summary = {
        "training": options.training.to_dict(),
        "started_from": None if start is None else start.sha256,
        "evaluator": evaluator.network.config.to_dict(),
        "last_losses": losses,
        "train_clips": len(corpus.split("train")),
    }
    (options.out / "training.json").write_text(json.dumps(summary, indent=2) + "\n")
    console.print(f"written to {options.out}")
    return 0
