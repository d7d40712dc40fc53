"""Do samples do what statements say, asked for in their very words?

    python -m benchmarks.stated [--samples 3] [--weights DIR] [--json F]

Texts that the weights were trained on, and windows whose kinematics leave no doubt about them: what
is missing here is not the language. `corpus.statements` judges the bare sampler's motions of 5 s.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from rich.table import Table

from motiondiffuse_ros.corpus.statements import sentences_by_kind, state
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.planner import shipped_weights

SECONDS = 5.0
BATCH = 48


@dataclass(frozen=True)
class Options:
    """What to run."""

    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    samples: int = 3
    """Of each sentence."""
    guidance_scale: float = SamplerConfig.guidance_scale
    """Weight of the text."""
    json: Path | None = None
    """Where to write the shares."""


def main() -> None:
    """Sample, judge and print the shares by kind."""
    options = tyro.cli(Options, description=__doc__)
    pipeline = MotionPipeline.from_pretrained(options.weights or shipped_weights())
    config = replace(SamplerConfig(), guidance_scale=options.guidance_scale)
    asked = [(kind, text) for kind, texts in sentences_by_kind().items() for text in texts]
    frames = round(SECONDS * pipeline.fps)
    held: dict[str, list[bool]] = {kind: [] for kind, _ in asked}
    batches = [
        (seed, asked[start : start + BATCH])
        for seed in range(options.samples)
        for start in range(0, len(asked), BATCH)
    ]
    for number, (_, batch) in enumerate(track(batches, "sampling")):
        texts = [text for _, text in batch]
        motions = pipeline.batch(texts, [frames] * len(batch), config=config, seed=number)
        for (kind, text), motion in zip(batch, motions, strict=True):
            features = pipeline.representation.encode(motion)
            stated = state(features, pipeline.representation, motion.fps)
            held[kind].append(any(text in s.texts for s in stated if s.kind == kind))
    shares = {kind: float(np.mean(values)) for kind, values in held.items()}
    table = Table("kind", "samples", "hold")
    for kind, share in shares.items():
        table.add_row(kind, str(len(held[kind])), f"{share:.0%}")
    Console().print(table)
    mean = float(np.mean(list(shares.values())))
    print(f"mean over kinds {mean:.1%}")
    if options.json is not None:
        result = {
            "weights_sha256": pipeline.weights_sha256,
            "few_steps_sha256": pipeline.few_steps_sha256(config),
            "samples": options.samples,
            "mean": mean,
            "shares": shares,
        }
        options.json.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
