"""Print the tables of `motiondiffuse evaluate` as Markdown, for the documentation.

python -m benchmarks.evaluation_tables --json benchmarks/evaluation_test.json
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import tyro

from motiondiffuse_ros.evaluation.tables import (
    markdown_table,
    metrics_cells,
    plausibility_cells,
    rows_from_json,
)


@dataclass(frozen=True)
class Options:
    """What to print."""

    json: Path = Path("benchmarks/evaluation_test.json")
    """File that `motiondiffuse evaluate` wrote."""


def main() -> None:
    """Print the tables."""
    result = json.loads(tyro.cli(Options).json.read_text(encoding="utf-8"))
    texts = rows_from_json(result["rows"])
    print(f"{result['clips']} clips, {result['repeats']} repeats\n")
    print(markdown_table(metrics_cells(texts)))
    if result["actions"] is not None:
        print(markdown_table(metrics_cells(rows_from_json(result["actions"]))))
    print(markdown_table(plausibility_cells(texts)))


if __name__ == "__main__":
    main()
