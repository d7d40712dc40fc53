"""`motiondiffuse distill`: teach a denoiser to need few steps."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.training.distill_config import DistillConfig


@dataclass(frozen=True)
class Distill:
    """Teach a student to do in one step what its teacher does in two, guidance included.

    Leaves in the output folder: checkpoint/ (to generate with) and log.jsonl.
    """

    corpus: Path = Path("corpus")
    """Corpus folder made by `motiondiffuse corpus build`."""
    out: Path = Path("runs/few_steps")
    """Folder of the run."""
    teacher: Path | None = None
    """Checkpoint folder to learn from; the shipped one if not given."""
    start: Path | None = None
    """Checkpoint folder whose few steps to go on from, instead of the teacher's weights."""
    distilling: DistillConfig = field(default_factory=DistillConfig)


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    options = parse(Distill, arguments, "distill")
    options.distilling.validate()
    from motiondiffuse_ros.corpus.store import Corpus
    from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
    from motiondiffuse_ros.memory import keep_freed_memory
    from motiondiffuse_ros.planner import shipped_weights
    from motiondiffuse_ros.text import load_text_encoder
    from motiondiffuse_ros.training.distillation import Distiller, DistillProgress

    keep_freed_memory()
    teacher = Checkpoint.from_pretrained(options.teacher or shipped_weights())
    with Progress(TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()) as bar:
        task = bar.add_task("captions", total=options.distilling.minutes)
        distiller = Distiller(
            Corpus.load(options.corpus),
            load_text_encoder(teacher.denoiser.config.text_encoder),
            teacher,
            options.distilling,
            options.out,
            student=(
                None
                if options.start is None
                else Checkpoint.from_pretrained(options.start).few_steps
            ),
        )

        def show(p: DistillProgress) -> None:
            bar.update(
                task,
                completed=p.minutes,
                description=f"step {p.step}, loss {p.loss:.4f}, validation {p.validation:.4f}",
            )

        # the shell lets background jobs ignore SIGINT; both stop the run after its step
        for stop in (signal.SIGINT, signal.SIGTERM):
            signal.signal(stop, lambda *_: distiller.stop())
        distiller.run(show)
    return 0
