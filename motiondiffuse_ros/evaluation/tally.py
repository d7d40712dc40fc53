"""Figures of every repeat, gathered into the rows of a table."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

from motiondiffuse_ros.evaluation.metrics import Estimate


@dataclass(frozen=True)
class Row:
    """One line of a table.

    Attributes:
        name: Where the motions are from: real, training, random, retrieval or generated.
        metrics: Estimates by name; a metric that does not apply is missing.
    """

    name: str
    metrics: dict[str, Estimate]


class Tally:
    """Figures by source and metric."""

    def __init__(self) -> None:
        self._taken: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))

    def add(self, name: str, figures: Mapping[str, float]) -> None:
        """Add one repeat's figures of a source."""
        for metric, value in figures.items():
            self._taken[name][metric].append(value)

    def rows(self) -> list[Row]:
        """Return a row for each source, in the order of their first figures."""
        return [
            Row(name, {m: Estimate.of(v) for m, v in taken.items()})
            for name, taken in self._taken.items()
        ]
