"""A score that was fitted to real clips and the same clips broken.

A generalised additive model: each named statistic goes through a curve of straight pieces, whose
corners are quantiles of real clips, and what the curves say is added up to the log odds that the
motion is real. So each statistic's part in a verdict can be named. `benchmarks/fit_score.py` fits
it on the training split and writes `fitted_score.json`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import expit

from motiondiffuse_ros.motion.rotations import Array

KNOTS = (0.02, 0.1, 0.3, 0.7, 0.9, 0.98)
"""Quantiles of real clips at which a curve may bend."""

_FILE = Path(__file__).with_name("fitted_score.json")
_FARTHEST = 6.0  # spreads; what is farther off is no worse


@dataclass(frozen=True, eq=False)
class FittedScore:
    """The model; S statistics, seven weights each.

    Attributes:
        names: Of the statistics [S].
        centre: Median over real clips [S].
        spread: Half the distance of their 5 and 95 % quantiles [S].
        knots: Values at `KNOTS` [6, S].
        weights: Of the straight line and of what is beyond each knot [7, S].
        bias: Log odds of a motion all of whose statistics are at the centre.
        marginal_below: A score below this is marginal.
    """

    names: tuple[str, ...] = field(repr=False)
    centre: Array = field(repr=False)
    spread: Array = field(repr=False)
    knots: Array = field(repr=False)
    weights: Array = field(repr=False)
    bias: float
    marginal_below: float

    def score(self, values: Mapping[str, float]) -> float:
        """Return the chance that a motion is real, half of all being so."""
        return float(expit(self.bias + self.parts(values).sum()))

    def parts(self, values: Mapping[str, float]) -> Array:
        """Return what each statistic adds to the log odds [S]."""
        x = np.array([[values[name] for name in self.names]])
        return (self.basis(x)[0] * self.weights).sum(axis=0)

    def basis(self, x: Array) -> Array:
        """Return what the weights multiply [N, 7, S] for statistics [N, S]."""
        line = np.clip((x - self.centre) / self.spread, -_FARTHEST, _FARTHEST)
        half = len(KNOTS) // 2
        below = (self.knots[None, :half] - x[:, None]) / self.spread
        above = (x[:, None] - self.knots[None, half:]) / self.spread
        hinges = np.clip(np.concatenate([below, above], axis=1), 0.0, _FARTHEST)
        return np.concatenate([line[:, None], hinges], axis=1)

    def worst(self, values: Mapping[str, float], count: int) -> list[str]:
        """Say which statistics speak most against a motion, and how real motion has them.

        Those outside the range of nearly all real motion come first.
        """
        x = np.array([values[name] for name in self.names])
        beyond = (x < self.knots[0]) | (x > self.knots[-1])
        order = np.lexsort((self.parts(values), ~beyond))
        said = []
        for n in order[:count]:
            name, low, high = self.names[n], self.knots[0, n], self.knots[-1, n]
            said.append(
                f"{name.replace('_', ' ')} is {values[name]:.3g}, "
                f"in real motion mostly {low:.3g} to {high:.3g}"
            )
        return said

    def to_dict(self) -> dict[str, Any]:
        """Return what the JSON file holds."""
        arrays = ("centre", "spread", "knots", "weights")
        rounded = {
            name: np.vectorize(lambda v: float(f"{v:.5g}"))(getattr(self, name)).tolist()
            for name in arrays
        }
        plain = ("bias", "marginal_below")
        return {"names": list(self.names), **rounded, **{n: getattr(self, n) for n in plain}}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> FittedScore:
        """Undo `to_dict`."""
        arrays = {name: np.array(data[name]) for name in ("centre", "spread", "knots", "weights")}
        return cls(
            names=tuple(data["names"]),
            **arrays,
            bias=float(data["bias"]),
            marginal_below=float(data["marginal_below"]),
        )


@cache
def fitted_score() -> FittedScore:
    """Return the shipped model."""
    return FittedScore.from_dict(json.loads(_FILE.read_text(encoding="utf-8"))["model"])
