"""How well motions are executed without assistance: the table of docs/tracking.md.

    python -m benchmarks.physics_tracking --corpus runs/corpus --out tracking.json

Tracks the clips of benchmarks/tracking_clips.json (from the test split of a corpus of CMU and
Bandai-Namco), or with `--generated` what the planner makes of a few prompts. Every result is
written as it comes; the same command again goes on where it was stopped.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics import put_on_floor
from motiondiffuse_ros.physics.tracking import SamplingConfig, track, track_by_sampling

CLIPS = Path(__file__).with_name("tracking_clips.json")
PROMPTS = {
    "gesture": ("a person waves with the right hand", "a person raises both hands"),
    "walk": ("a person walks forward", "a person walks slowly", "a person walks backwards"),
    "turn": ("a person walks and turns left", "a person walks in a circle"),
    "run": ("a person runs forward",),
}
GENERATED_SECONDS = 5.0


@dataclass
class Arguments:
    """What to track, and how."""

    corpus: Path = Path("runs/corpus")
    """Corpus folder with the clips."""
    out: Path = Path("runs/tracking.json")
    """Results, and what a second run goes on from."""
    generated: bool = False
    """Track generated motions instead."""
    weights: Path | None = None
    """Checkpoint folder for them; the shipped one if not given."""
    kinds: tuple[str, ...] = ("gesture", "walk", "turn", "run")
    """Kinds of motion."""
    first: int = 100
    """How many of each kind."""
    seconds: float = 20.0
    """At most the first seconds of each motion."""
    sampling: SamplingConfig = field(default_factory=SamplingConfig)
    """Settings of the tracking."""


def main() -> None:
    """Track what is missing and print the table."""
    options = tyro.cli(Arguments, description=__doc__)
    console = Console()
    settings = {
        **asdict(options.sampling),
        "seconds": options.seconds,
        "generated": options.generated,
        "cores": os.cpu_count(),
    }
    settings = json.loads(json.dumps(settings))
    results = read_results(options.out, settings)
    for kind, name, motion in motions(options):
        if name not in results:
            results[name] = result(kind, motion, options.sampling)
            write_results(options.out, settings, results)
        console.print(line(name, results[name]), highlight=False)
    console.print(table(list(results.values())))


def motions(options: Arguments) -> Iterator[tuple[str, str, Motion]]:
    """Yield kind, name and motion of all that is to be tracked."""
    source = generated_motions(options) if options.generated else clips(options)
    for kind, name, motion in source:
        frames = round(options.seconds * motion.fps) + 1
        yield kind, name, put_on_floor(motion.slice(0, frames))


def clips(options: Arguments) -> Iterator[tuple[str, str, Motion]]:
    """Yield the listed clips of the corpus."""
    corpus = Corpus.load(options.corpus)
    by_name = {clip.name: clip for clip in corpus.split("test")}
    listed: dict[str, list[str]] = json.loads(CLIPS.read_text(encoding="utf-8"))
    for kind in options.kinds:
        for name in listed[kind][: options.first]:
            features = corpus.of(by_name[name])
            yield kind, name, corpus.representation.decode(features, corpus.fps)


def generated_motions(options: Arguments) -> Iterator[tuple[str, str, Motion]]:
    """Yield what the planner makes of the prompts."""
    from motiondiffuse_ros.planner import Planner, PlannerConfig
    from motiondiffuse_ros.request import MotionRequest

    planner = Planner(PlannerConfig(weights=options.weights, track=False))
    for kind in options.kinds:
        for text in PROMPTS[kind][: options.first]:
            request = MotionRequest.from_text(text, GENERATED_SECONDS, seed=0)
            yield kind, text, planner.plan(request).motion


def result(kind: str, motion: Motion, sampling: SamplingConfig) -> dict[str, Any]:
    """Track one motion both ways."""
    began = time.process_time()
    executed = track_by_sampling(motion, sampling)
    core_seconds = time.process_time() - began
    plain = track(motion)
    return {
        "kind": kind,
        "duration_s": motion.duration,
        **executed.to_dict(),
        "core_seconds": core_seconds,
        "pd_success": not plain.fell,
        "pd_time_to_fall_s": plain.time_to_fall,
    }


def read_results(path: Path, settings: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return earlier results of the same settings."""
    if not path.exists():
        return {}
    earlier = json.loads(path.read_text(encoding="utf-8"))
    if earlier["settings"] != settings:
        raise SystemExit(f"{path} has results of other settings; choose another --out")
    return earlier["results"]


def write_results(path: Path, settings: dict[str, Any], results: dict[str, dict[str, Any]]) -> None:
    """Replace the file at once."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    content = {"settings": settings, "summary": summary(results), "results": results}
    part.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    os.replace(part, path)


def summary(results: dict[str, dict[str, Any]]) -> dict[str, dict[str, float]]:
    """Return the figures of the table by kind."""
    kinds = dict.fromkeys(r["kind"] for r in results.values())
    return {kind: figures([r for r in results.values() if r["kind"] == kind]) for kind in kinds}


def figures(results: list[dict[str, Any]]) -> dict[str, float]:
    """Return the figures of some results; errors are of those that succeed."""
    stood = [r for r in results if r["success"]]
    return {
        "motions": len(results),
        "success": float(np.mean([r["success"] for r in results])),
        "mpjpe_mm": float(np.mean([r["mpjpe_mm"] for r in stood])) if stood else float("nan"),
        "mpjpe_worst_mm": max((r["mpjpe_mm"] for r in stood), default=float("nan")),
        "times_real_time": sum(r["seconds"] for r in results)
        / sum(r["time_to_fall_s"] for r in results),
        # what it would take on one core that is not shared
        "core_times_real_time": sum(r["core_seconds"] for r in results)
        / sum(r["time_to_fall_s"] for r in results),
        "pd_success": float(np.mean([r["pd_success"] for r in results])),
    }


def line(name: str, found: dict[str, Any]) -> str:
    """Return one result as a line."""
    end = "to the end" if found["success"] else f"fell at {found['time_to_fall_s']:.2f} s"
    return (
        f"{name}: {found['duration_s']:.1f} s, {end}, {found['mpjpe_mm']:.0f} mm, "
        f"{found['seconds'] / found['time_to_fall_s']:.1f} times real time"
    )


def table(results: list[dict[str, Any]]) -> Table:
    """Return the table by kind."""
    columns = ("kind", "motions", "success", "PD alone", "MPJPE mm", "worst")
    out = Table(*columns, "times real time", "core time", box=None)
    for kind, f in summary({str(n): r for n, r in enumerate(results)}).items():
        out.add_row(
            kind,
            f"{f['motions']:.0f}",
            f"{f['success']:.0%}",
            f"{f['pd_success']:.0%}",
            f"{f['mpjpe_mm']:.0f}",
            f"{f['mpjpe_worst_mm']:.0f}",
            f"{f['times_real_time']:.1f}",
            f"{f['core_times_real_time']:.1f}",
        )
    return out


if __name__ == "__main__":
    main()
