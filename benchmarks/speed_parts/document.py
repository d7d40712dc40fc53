"""Tables of measurements inside a document."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.speed_parts.summary import summary_rows


def write_between_marks(path: Path, name: str, text: str) -> None:
    """Replace what stands between `<!-- name -->` and `<!-- end of name -->` in a document."""
    document = path.read_text(encoding="utf-8")
    start, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    if start not in document or end not in document:
        raise SystemExit(f"{path}: lacks the marks {start} and {end} around its tables")
    before, rest = document.split(start, 1)
    after = rest.split(end, 1)[1]
    path.write_text(f"{before}{start}\n{text.strip()}\n{end}{after}", encoding="utf-8")


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def markdown(record: dict[str, Any]) -> str:
    """Return the tables of speed.json."""
    machine, settings = record["machine"], record["settings"]
    lengths = [
        (
            f"{row['motion_s']:g}",
            f"{row['plan_s']:.2f}",
            f"{row['sampling_s']:.2f}",
            f"{row['physics_s']:.2f}",
            f"{row['own_mb']:.1f}",
            *_memory(row),
            f"{one['plan_s']:.2f}",
            *_memory(one),
        )
        for row, one in zip(record["lengths"], record["lengths_one_candidate"], strict=True)
    ]
    counts = sorted({row["threads"] for row in record["batches"]})
    took = {(row["batch"], row["threads"]): row["sampling_s"] for row in record["batches"]}
    batches = [
        (str(batch), *(f"{took[batch, n]:.2f}" for n in counts))
        for batch in sorted({batch for batch, _ in took})
    ]
    units = ", ".join(machine["matrix_units"])
    return "\n".join(
        [
            f"{machine['processor']} ({units}), "
            f"{machine['cores']} cores; {record['gigaflops']:.0f} GFLOP/s on large matrix products "
            f"in the arithmetic that sampling uses, {record['gigaflops_fp32']:.0f} in float32; "
            f"load before the run {machine['load_before']:.2f}. "
            f"{settings['seconds']:g} s, {settings['candidates']} candidates, medians over "
            f"{settings['repeats']} repeats.\n",
            table(("", "measured", "asked"), summary_rows(record)),
            f"Time and memory against length, {settings['candidates']} candidates:\n",
            table(
                (
                    "motion, s",
                    "plan, s",
                    "sampling, s",
                    "physics, s",
                    "own size, MiB",
                    "peak, MiB",
                    "kept, MiB",
                    "one candidate: plan, s",
                    "peak, MiB",
                    "kept, MiB",
                ),
                lengths,
            ),
            f"Sampling time, s, of motions of {settings['seconds']:g} s at once:\n",
            table(("motions", *(f"{n} threads" for n in counts)), batches),
        ]
    )


def _memory(row: dict[str, float]) -> tuple[str, ...]:
    return tuple(f"{row[when] - row['before_mb']:.0f}" for when in ("peak_mb", "after_mb"))
