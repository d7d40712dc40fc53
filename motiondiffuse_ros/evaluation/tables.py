"""Tables of figures: for the terminal, for Markdown and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.table import Table

from motiondiffuse_ros.evaluation.metrics import Estimate
from motiondiffuse_ros.evaluation.tally import Row


def rows_to_json(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return rows as JSON types; an estimate is [mean, half-width of the 95 % interval]."""
    return [
        {
            "name": row.name,
            "metrics": {
                name: [round(e.mean, 5), round(e.interval, 5)] for name, e in row.metrics.items()
            },
            **(
                {"plausibility": {k: round(v, 4) for k, v in row.plausibility.items()}}
                if row.plausibility
                else {}
            ),
        }
        for row in rows
    ]


def metrics_cells(rows: Sequence[Row]) -> list[list[str]]:
    """Return the header and a line for each row; a metric that does not apply is a dash."""
    names = list(dict.fromkeys(name for row in rows for name in row.metrics))
    lines = [[row.name, *(_estimate(row.metrics.get(name)) for name in names)] for row in rows]
    return [["", *names], *lines]


def plausibility_cells(rows: Sequence[Row]) -> list[list[str]]:
    """The same for the physical measures, for the rows that have them."""
    measured = [row for row in rows if row.plausibility]
    names = list(measured[0].plausibility) if measured else []
    lines = [[row.name, *(f"{row.plausibility[n]:.3g}" for n in names)] for row in measured]
    return [["", *names], *lines]


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


def _estimate(value: Estimate | None) -> str:
    return "–" if value is None else f"{value.mean:.3f} ± {value.interval:.3f}"
