"""How well the verdict tells real clips from corrupted ones: the table of docs/physics.md.

    python benchmarks/physics_verdict.py --corpus runs/corpus

Takes clips on level ground of both sets at random from a split, corrupts each in every way of
`benchmarks/corruptions.py`, and prints the share of each verdict, the mean score and the area
under the ROC of the score (real against that corruption, and against all together). A second
table has the quantiles of real clips for each criterion; thresholds are set on the training split.
"""

from __future__ import annotations

import json
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.corruptions import CORRUPTIONS
from benchmarks.level_clips import level_clips
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.physics import Report, assess, put_on_floor
from motiondiffuse_ros.physics.criteria import CRITERIA

VERDICTS = ("plausible", "marginal", "implausible")
SETS = ("cmu", "bandai_namco")
REAL, ALL = "real", "all together"


@dataclass
class Arguments:
    """Which clips."""

    corpus: Path
    """Corpus folder."""
    split: str = "test"
    """train to set thresholds, test to show them."""
    clips: int = 200
    """Of both sets together."""
    max_seconds: float = 8.0
    """Of each clip."""
    seed: int = 2
    """Of the choice and the corruptions."""
    on_floor: bool = False
    """Take the floor of each clip to be where its stance is, not where its import has it."""
    corrupt: bool = True
    """Also judge the corrupted clips."""
    json: Path | None = None
    """Also write the figures here."""


def area_under_roc(real: np.ndarray, corrupted: np.ndarray) -> float:
    """Return the chance that a real clip scores higher than a corrupted one."""
    difference = real[:, None] - corrupted[None]
    return float(np.mean((difference > 0.0) + 0.5 * (difference == 0.0)))


def verdict_figures(rows: dict[str, list[tuple[str, Report]]]) -> dict[str, dict[str, float]]:
    """Return shares of the verdicts, of what passes in each set, mean score and ROC area."""
    real = np.array([report.score for _, report in rows[REAL]])
    figures = {}
    for kind, results in rows.items():
        scores = np.array([report.score for _, report in results])
        verdicts = np.array([report.verdict for _, report in results])
        sets = np.array([name for name, _ in results])
        figures[kind] = {v: float(np.mean(verdicts == v)) for v in VERDICTS}
        for name in SETS:
            figures[kind][name] = float(np.mean(verdicts[sets == name] != "implausible"))
        figures[kind]["score"] = float(scores.mean())
        figures[kind]["roc_area"] = area_under_roc(real, scores)
    return figures


def verdict_table(figures: dict[str, dict[str, float]]) -> Table:
    """Lay out `verdict_figures`."""
    table = Table("", *VERDICTS, "not implausible: cmu", "b-n", "mean score", "ROC area")
    for kind, row in figures.items():
        shares = [f"{row[key]:.0%}" for key in (*VERDICTS, *SETS)]
        area = "" if kind == REAL else f"{row['roc_area']:.3f}"
        table.add_row(kind, *shares, f"{row['score']:.2f}", area)
    return table


def quantile_table(real: list[tuple[str, Report]]) -> Table:
    """Return the criteria with quantiles over real clips and their thresholds."""
    quantiles = (0.5, 0.9, 0.95, 0.98)
    heads = [f"{name} {q:.0%}" for name in ("cmu", "b-n") for q in quantiles]
    table = Table("criterion", *heads, "marginal", "implausible")
    for criterion in CRITERIA:
        cells = []
        for name in SETS:
            values = [report.metrics[criterion.name] or 0.0 for s, report in real if s == name]
            cells += [f"{v:.3g}" for v in np.quantile(values, quantiles)]
        table.add_row(criterion.name, *cells, str(criterion.marginal), str(criterion.implausible))
    return table


def main(arguments: Arguments) -> None:
    """Print the table and write the figures."""
    rng = np.random.default_rng(arguments.seed)
    corpus = Corpus.load(arguments.corpus)
    clips = level_clips(corpus, arguments.split, arguments.clips, arguments.max_seconds, rng)
    rows: dict[str, list[tuple[str, Report]]] = {REAL: []}
    kinds = CORRUPTIONS if arguments.corrupt else {}
    rows |= {name: [] for name in kinds}
    seconds = spent = 0.0
    for clip, motion in track(clips, description="clips"):
        if arguments.on_floor:
            motion = put_on_floor(motion)
        broken = {kind: corruption.apply(motion, rng) for kind, corruption in kinds.items()}
        for kind, changed in ({REAL: motion} | broken).items():
            begin = time.process_time()
            report = assess(changed, track=False)
            spent += time.process_time() - begin
            seconds += changed.duration
            # a report's series would fill the memory
            rows[kind].append((clip.dataset, replace(report, series={})))
    if kinds:
        rows[ALL] = [row for kind in kinds for row in rows[kind]]
    figures = verdict_figures(rows)
    Console(width=140).print(verdict_table(figures))
    Console(width=200).print(quantile_table(rows[REAL]))
    Console().print(f"{len(clips)} clips; {seconds / spent:.0f} times real time of one core")
    if arguments.json is not None:
        summary = {"rows": figures, "clips": len(clips), "seed": arguments.seed}
        arguments.json.write_text(json.dumps(summary | {"realtime_factor": seconds / spent}))


if __name__ == "__main__":
    main(tyro.cli(Arguments))
