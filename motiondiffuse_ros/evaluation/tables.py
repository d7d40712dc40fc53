"""Tables of figures: for the terminal, for Markdown and as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table

from motiondiffuse_ros.evaluation.metrics import Estimate
from motiondiffuse_ros.evaluation.plausibility import MEASURES
from motiondiffuse_ros.evaluation.tally import Row

_HEADINGS = {
    **{f"r_precision_top{top}": f"R top {top}" for top in (1, 2, 3)},
    "mm_dist": "MM dist",
    "fid": "FID",
    "diversity": "Diversity",
    "multimodality": "MultiModality",
    "accuracy": "Accuracy",
    "phys_err_mm": "phys-err mm",
    "float_mm": "float mm",
    "penetrate_mm": "penetrate mm",
    "skating_ratio": "skating ratio",
    "jerk_m_s3": "jerk m/s³",
}
_SOURCES = {
    "real": "real motion",
    "training": "real training clips",
    "random": "random clip",
    "retrieval": "nearest caption",
    "generated": "generated",
}


def rows_to_json(rows: Sequence[Row]) -> dict[str, dict[str, dict[str, float] | None]]:
    """Return rows by name as JSON types; a metric that does not apply to a row is null."""
    names = _metrics(rows)
    return {row.name: {n: _to_json(row.metrics.get(n)) for n in names} for row in rows}


def rows_from_json(data: Mapping[str, Mapping[str, Mapping[str, float] | None]]) -> list[Row]:
    """Undo `rows_to_json`."""
    return [
        Row(name, {n: Estimate(v["mean"], v["ci95"]) for n, v in metrics.items() if v is not None})
        for name, metrics in data.items()
    ]


def metrics_cells(rows: Sequence[Row]) -> list[list[str]]:
    """Return the header and a line for each row; a metric that does not apply is a dash."""
    return _cells(rows, [name for name in _metrics(rows) if name not in MEASURES])


def plausibility_cells(rows: Sequence[Row]) -> list[list[str]]:
    """The same for the physical measures, for the rows that have them."""
    measured = [row for row in rows if MEASURES[0] in row.metrics]
    return _cells(measured, list(MEASURES))


def terminal_table(cells: Sequence[Sequence[str]], title: str) -> Table:
    """Return a table for rich."""
    table = Table(*cells[0], title=title)
    for line in cells[1:]:
        table.add_row(*line)
    return table


def markdown_table(cells: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [cells[0], ["---"] * len(cells[0]), *cells[1:]]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def _cells(rows: Sequence[Row], names: Sequence[str]) -> list[list[str]]:
    header = ["", *(_HEADINGS[name] for name in names)]
    lines = [
        [_SOURCES.get(row.name, row.name), *(_shown(row.metrics.get(n)) for n in names)]
        for row in rows
    ]
    return [header, *lines]


def _metrics(rows: Sequence[Row]) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row.metrics))


def _shown(value: Estimate | None) -> str:
    if value is None:
        return "–"
    digits = 3 if abs(value.mean) < 10.0 else 1
    return f"{value.mean:.{digits}f} ± {value.interval:.{digits}f}"


def _to_json(value: Estimate | None) -> dict[str, Any] | None:
    if value is None:
        return None
    return {"mean": float(value.mean), "ci95": float(value.interval)}
