"""How fast is all of it, and how far from what the machine could do?

    python -m benchmarks.speed [--quick] [--json F] [--docs docs/performance.md]

Takes a quarter of an hour on two cores, which nothing else should use. The node is a process of
its own and is asked over ROS 2 by another; long motions have processes of their own, too; all other
figures are of this process. Every figure stands beside a reference of the same run: the paper's
configuration (8 layers, 512 wide, 1000 DDPM steps, of which a few dozen are run and scaled), real
time, or the floor (operations of one request's matrix products over the rate that the machine
reaches on large ones).
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import tyro
from rich.console import Console
from rich.table import Table

from benchmarks.speed_parts.checks import measure_checks
from benchmarks.speed_parts.clock import machine
from benchmarks.speed_parts.document import markdown, write_between_marks
from benchmarks.speed_parts.long_motion import measure_long
from benchmarks.speed_parts.node import as_typed, measure_starts, measure_streaming
from benchmarks.speed_parts.sampling import measure_sampling
from benchmarks.speed_parts.scaling import attention_rows, batch_rows, draw
from benchmarks.speed_parts.summary import summary_rows

LENGTHS = (2.0, 6.0, 30.0, 120.0, 300.0, 600.0)
BATCHES = (1, 2, 4, 8, 16, 32, 64)
STREAMED: tuple[dict[str, object], ...] = (
    {"horizon": 2.0},
    {"horizon": 2.0, "few_steps": False},
    {"horizon": 2.0, "first_candidates": 4},
    {"steps": 5},
)
"""Parameters of the node with which first set-points are measured, too."""
TOKENS = (64, 128, 256, 512, 1024, 2048, 4096)


@dataclass(frozen=True)
class Options:
    """What to measure."""

    quick: bool = False
    """Few repeats, and no motions of minutes."""
    seconds: float = 6.0
    """Length of the request [s]."""
    candidates: int = 4
    """Motions to choose from, the planner's default."""
    repeats: int = 20
    """Sentences sent to the node, and repeats of other times."""
    starts: int = 5
    """Starts of the node."""
    paper_steps: int = 30
    """Of the paper's 1000 steps, how many are run."""
    robots: tuple[str, ...] = ("humanoid",)
    """Robots whose retargeting is measured; the first one's is `retarget_realtime_factor`."""
    parameters: dict[str, str] = field(default_factory=dict)
    """Parameters of the node, beside the length, as YAML has them."""
    json: Path | None = None
    """Where to write the figures."""
    docs: Path | None = None
    """Document whose tables are replaced."""
    marks: str = "speed"
    """Name of the marks between which they stand; the plot beside the document is of `speed`."""
    from_json: Path | None = None
    """Measure nothing: take the figures of an earlier run, to print or document them again."""


def measure(options: Options) -> dict[str, Any]:
    """Return the content of speed.json."""
    quick = options.quick
    repeats = min(options.repeats, 3) if quick else options.repeats
    record: dict[str, Any] = {"machine": machine()}
    parameters = as_typed(options.parameters)
    starts = 1 if quick else options.starts
    record |= measure_starts(options.seconds, repeats, starts, parameters)
    record["streamed"] = [
        measure_streaming(options.seconds, repeats, {**parameters, **wanted}) for wanted in STREAMED
    ]
    sampling = measure_sampling(
        options.seconds, options.candidates, repeats, 3 if quick else options.paper_steps
    )
    record |= sampling.to_dict()
    record |= measure_checks(options.seconds, repeats, options.robots)
    lengths = LENGTHS[:3] if quick else LENGTHS
    record["lengths"] = [measure_long(length, options.candidates) for length in lengths]
    record["lengths_one_candidate"] = [measure_long(length, 1) for length in lengths]
    record["ten_minutes_s"] = None if quick else record["lengths"][-1]["plan_s"]
    batches, cores = BATCHES[:2] if quick else BATCHES, record["machine"]["cores"]
    record["batches"] = batch_rows(options.seconds, batches, (1, cores), 1 if quick else 3)
    record["attention"] = attention_rows(TOKENS[:3] if quick else TOKENS, repeats)
    settings = asdict(options)
    record["settings"] = {k: settings[k] for k in ("seconds", "candidates", "parameters", "quick")}
    record["settings"]["repeats"] = repeats
    return record


def main(options: Options) -> None:
    """Measure, print, and write what was asked for."""
    if options.from_json is None:
        record = measure(options)
    else:
        record = json.loads(options.from_json.read_text(encoding="utf-8"))
    table = Table("", "measured", "asked")
    for row in summary_rows(record):
        table.add_row(*row)
    Console().print(table)
    if options.json is not None:
        options.json.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    if options.docs is not None:
        write_between_marks(options.docs, options.marks, markdown(record))
        if options.marks == Options.marks:
            draw(record["lengths"], record["attention"], options.docs.parent / "scaling.png")


if __name__ == "__main__":
    main(tyro.cli(Options))
