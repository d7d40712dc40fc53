"""What do fewer denoising steps cost? Quality and time of samplers against 1000 steps of DDPM.

    python -m benchmarks.quality_steps [--corpus F] [--clips 96] [--json F] [--docs F]

Every sampler answers the captions of the same clips with the same seeds, as `motiondiffuse
evaluate` asks them and before any repair. FID depends on the number of clips, so that it only
compares with the rows here.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.speed_parts.document import table, write_between_marks
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.evaluation.evaluator import Evaluator, shipped_evaluator
from motiondiffuse_ros.evaluation.items import Item, draw_items
from motiondiffuse_ros.evaluation.metrics import POOL, frechet_distance, pools, retrieval
from motiondiffuse_ros.evaluation.plausibility import plausibility
from motiondiffuse_ros.evaluation.sources import Model
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.text import load_text_encoder

SAMPLERS = (
    ("ddpm", 1000),
    ("ddpm", 50),
    *(("ddim", steps) for steps in (50, 20, 10, 5)),
    *(("dpm-solver++", steps) for steps in (50, 24, 20, 16, 12, 10, 8, 6, 5)),
)
"""Schedulers and their steps; where there are weights for so few, those are used."""
HEAD = ("sampler", "steps", "R-precision top 1", "top 3", "FID", "phys-err mm", "jerk", "s a clip")


@dataclass(frozen=True)
class Options:
    """What to compare."""

    corpus: Path = Path("runs/corpus")
    """Corpus folder made by `motiondiffuse corpus build`."""
    split: str = "test"
    """Whose captions are asked for."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    clips: int = 96
    """How many captions every sampler answers."""
    repeats: int = 1
    """How often, each time with other captions and seeds; 1000 steps only once."""
    most_steps: int = 1000
    """Samplers with more steps are left out."""
    seed: int = 0
    """Of all draws."""
    json: Path | None = None
    """Where to write the figures."""
    docs: Path | None = None
    """Document whose table is replaced."""
    from_json: Path | None = None
    """Measure nothing: take the figures of an earlier run."""


def measure(options: Options) -> dict[str, Any]:
    """Return the figures of every sampler, after those of the real clips."""
    corpus = Corpus.load(options.corpus)
    evaluator = Evaluator.from_pretrained(shipped_evaluator(), load_text_encoder("minilm"))
    pipeline = MotionPipeline.from_pretrained(options.weights or shipped_weights())
    drawn = [_draw(corpus, evaluator, options, repeat) for repeat in range(options.repeats)]
    real = [_figures(d, [i.features for i in d], evaluator, corpus) for d in drawn]
    rows = [_row("real", 0, real)]
    samplers = [s for s in SAMPLERS if s[1] <= options.most_steps]
    for scheduler, steps in track(samplers, "samplers"):
        config = SamplerConfig(scheduler=scheduler, steps=steps)
        model = Model(pipeline, config)
        figures = []
        for repeat, items in enumerate(drawn[:1] if steps >= 1000 else drawn):
            began = time.perf_counter()
            answers = model.motions(
                [item.text for item in items],
                [len(item.features) for item in items],
                options.seed + 1000 * repeat,
                [item.clip for item in items],
            )
            took = (time.perf_counter() - began) / len(items)
            figures.append(_figures(items, answers, evaluator, corpus) | {"seconds": took})
        name = "few steps" if pipeline.few_steps_sha256(config) else scheduler
        rows.append(_row(name, steps, figures))
    settings = asdict(options)
    return {
        "settings": {k: settings[k] for k in ("split", "clips", "repeats", "seed")},
        "weights_sha256": pipeline.weights_sha256,
        "default": {"scheduler": SamplerConfig.scheduler, "steps": SamplerConfig.steps},
        "rows": rows,
    }


def _draw(corpus: Corpus, evaluator: Evaluator, options: Options, repeat: int) -> list[Item]:
    rng = np.random.default_rng([options.seed, repeat])
    longest = evaluator.network.config.max_frames
    items = draw_items(corpus, corpus.split(options.split), longest, rng)
    # captions that are said once, or the pools of different ones would be few
    once = list({items[i].text: items[i] for i in rng.permutation(len(items))}.values())
    if len(once) < POOL:
        raise SystemExit(f"{options.corpus}: {len(once)} different captions, a pool needs {POOL}")
    return once[: options.clips]


def _figures(
    items: Sequence[Item], answers: Sequence[Array], evaluator: Evaluator, corpus: Corpus
) -> dict[str, float]:
    texts = [item.text for item in items]
    text, motion = evaluator.embed_texts(texts), evaluator.embed_motions(answers)
    real = evaluator.embed_motions([item.features for item in items])
    rng = np.random.default_rng(0)  # the same pools for all
    ranked = [retrieval(text[p], motion[p])[0] for _ in range(10) for p in pools(texts, rng)]
    tops = np.mean(ranked, axis=0)
    physics = plausibility(corpus.representation.decode(x, corpus.fps) for x in answers)
    return {
        "r_precision_top1": float(tops[0]),
        "r_precision_top3": float(tops[2]),
        "fid": frechet_distance(motion, real),
        **physics,
    }


def _row(scheduler: str, steps: int, figures: Sequence[dict[str, float]]) -> dict[str, Any]:
    means = {name: float(np.mean([f[name] for f in figures])) for name in figures[0]}
    return {"scheduler": scheduler, "steps": steps, **means}


def cells(record: dict[str, Any]) -> list[tuple[str, ...]]:
    """Return the table's rows."""
    return [
        (
            row["scheduler"],
            str(row["steps"] or ""),
            f"{row['r_precision_top1']:.3f}",
            f"{row['r_precision_top3']:.3f}",
            f"{row['fid']:.3f}",
            f"{row['phys_err_mm']:.1f}",
            f"{row['jerk_m_s3']:.0f}",
            f"{row['seconds']:.3f}" if "seconds" in row else "",
        )
        for row in record["rows"]
    ]


def main(options: Options) -> None:
    """Measure, print, and write what was asked for."""
    if options.from_json is None:
        record = measure(options)
    else:
        record = json.loads(options.from_json.read_text(encoding="utf-8"))
    shown = Table(*HEAD)
    for row in cells(record):
        shown.add_row(*row)
    Console().print(shown)
    if options.json is not None:
        options.json.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    if options.docs is not None:
        settings = record["settings"]
        said = (
            f"{settings['clips']} captions of the {settings['split']} split, "
            f"{settings['repeats']} repeats (1000 steps: one); default: "
            f"{record['default']['scheduler']}, {record['default']['steps']} steps.\n\n"
        )
        write_between_marks(options.docs, "steps", said + table(HEAD, cells(record)))


if __name__ == "__main__":
    main(tyro.cli(Options))
