"""`motiondiffuse evaluate`: the paper's tables for a set of weights."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import CheckpointError
from motiondiffuse_ros.evaluation.protocol import Protocol


@dataclass(frozen=True)
class Evaluate:
    """Measure weights on a split of a corpus, beside real motion and what needs no model.

    Writes JSON with every figure, the settings, the seed and the hashes of all weights, and prints
    the tables.
    """

    corpus: Path = Path("corpus")
    """Corpus folder made by `motiondiffuse corpus build`."""
    split: str = "test"
    """train, val, test, or all: every clip, for a corpus that the weights have never seen."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    text_encoder: Path | None = None
    """Folder of CLIP's files, for weights trained with it."""
    evaluator: Path | None = None
    """Evaluator folder; the shipped one if not given."""
    out: Path = Path("metrics.json")
    """File for the figures."""
    actions: bool = True
    """Also take the figures of action-conditioned generation, if clips have actions."""
    sampler: SamplerConfig = field(default_factory=SamplerConfig)
    protocol: Protocol = field(default_factory=Protocol)


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    options = parse(Evaluate, arguments, "evaluate")
    options.protocol.validate()
    options.sampler.validate()
    from motiondiffuse_ros.corpus.store import Corpus
    from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
    from motiondiffuse_ros.evaluation.action_protocol import clips_with_actions, evaluate_actions
    from motiondiffuse_ros.evaluation.evaluator import Evaluator, shipped_evaluator
    from motiondiffuse_ros.evaluation.protocol import evaluate_texts
    from motiondiffuse_ros.evaluation.sources import Model, NearestCaption, RandomClip
    from motiondiffuse_ros.evaluation.tables import (
        metrics_cells,
        plausibility_cells,
        rows_to_json,
        terminal_table,
    )
    from motiondiffuse_ros.planner import shipped_weights
    from motiondiffuse_ros.text import load_text_encoder

    corpus = Corpus.load(options.corpus)
    evaluator = Evaluator.from_pretrained(
        options.evaluator or shipped_evaluator(), load_text_encoder("minilm")
    )
    weights = options.weights or shipped_weights()
    pipeline = MotionPipeline.from_pretrained(weights, options.text_encoder)
    for what, name in (
        ("weights", pipeline.representation.name),
        ("evaluator", evaluator.representation),
    ):
        if name != corpus.representation.name:
            raise CheckpointError(
                f"the {what} speak {name}, the corpus {options.corpus} holds "
                f"{corpus.representation.name}"
            )
    if corpus.fps != pipeline.fps:
        raise CheckpointError(
            f"the weights speak {pipeline.fps:g} Hz, the corpus {options.corpus} holds "
            f"{corpus.fps:g} Hz"
        )
    console = Console()
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    tables = {}
    with Progress(*columns, console=console) as bar:
        sampled = bar.add_task("sampling", total=None)
        model = Model(
            pipeline,
            options.sampler,
            lambda done, total: bar.update(sampled, completed=done, total=total),
        )
        others = corpus.split("all" if options.split == "all" else "train")
        sources = (
            RandomClip(corpus, others),
            NearestCaption(corpus, others, evaluator.encoder),
            model,
        )
        kinds = {"texts": evaluate_texts}
        if options.actions and clips_with_actions(corpus, options.split, evaluator):
            kinds["actions"] = evaluate_actions
        for kind, evaluate in kinds.items():
            task = bar.add_task(kind, total=options.protocol.repeats * len(sources))
            tables[kind] = evaluate(
                corpus,
                options.split,
                evaluator,
                sources,
                options.protocol,
                lambda name, repeat, task=task: bar.advance(task),
            )
    texts, actions = tables["texts"], tables.get("actions")
    result = {
        "corpus": str(options.corpus),
        "split": options.split,
        "clips": len(corpus.split(options.split)),
        "repeats": options.protocol.repeats,
        "weights": weights.name,
        "weights_sha256": pipeline.weights_sha256,
        "few_steps_sha256": pipeline.few_steps_sha256(options.sampler),
        "evaluator_sha256": evaluator.sha256,
        "sampler": vars(options.sampler),
        "protocol": options.protocol.to_dict(),
        "rows": rows_to_json(texts),
        "actions": None if actions is None else rows_to_json(actions),
    }
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    for kind, rows in tables.items():
        console.print(terminal_table(metrics_cells(rows), f"{kind}, {options.split} split"))
    console.print(terminal_table(plausibility_cells(texts), "physics, before repair"))
    console.print(f"written to {options.out}")
    return 0
