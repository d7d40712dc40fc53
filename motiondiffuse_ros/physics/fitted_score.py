"""A score that was fitted to real clips and the same clips broken.

A small network: each named statistic is put on a scale of its own spread over real clips, one layer
of smooth switches weighs them against each other, and the sum of the switches is the log odds that
the motion is real. What matters together can so be weighed together: a quick step is right for a
run and wrong for a stroll. A statistic's part in a score is what the log odds would lose or gain if
it alone were that of the usual real clip. `benchmarks/fit_score.py` fits the network on the
training split and writes `fitted_score.json`.
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

RANGE = (0.02, 0.98)
"""Quantiles of real clips that are said to be how real motion mostly is."""

_FILE = Path(__file__).with_name("fitted_score.json")
_FARTHEST = 30.0  # spreads; what is farther off is no worse
_ARRAYS = ("centre", "spread", "range", "weights", "offsets", "outward")


@dataclass(frozen=True, eq=False)
class FittedScore:
    """The model; S statistics, H switches.

    Attributes:
        names: Of the statistics [S].
        centre: Median over real clips [S].
        spread: Half the distance of their 5 and 95 % quantiles [S].
        range: Values at `RANGE` [2, S].
        weights: Of the scaled statistics in each switch [H, S].
        offsets: Of each switch [H].
        outward: What each switch adds to the log odds [H].
        bias: Log odds without any.
        marginal_below: A score below this is marginal.
    """

    names: tuple[str, ...] = field(repr=False)
    centre: Array = field(repr=False)
    spread: Array = field(repr=False)
    range: Array = field(repr=False)
    weights: Array = field(repr=False)
    offsets: Array = field(repr=False)
    outward: Array = field(repr=False)
    bias: float
    marginal_below: float

    def score(self, values: Mapping[str, float]) -> float:
        """Return the chance that a motion is real, half of all being so."""
        x = np.array([[values[name] for name in self.names]])
        return float(expit(self.odds(self.scaled(x))[0]))

    def scaled(self, x: Array) -> Array:
        """Return statistics [..., S] in spreads off the centre, by a logarithm when far off."""
        off = np.clip((x - self.centre) / self.spread, -_FARTHEST, _FARTHEST)
        return np.sign(off) * np.log1p(np.abs(off))

    def odds(self, scaled: Array) -> Array:
        """Return the log odds [N] of scaled statistics [N, S]."""
        return self._of_switches(scaled @ self.weights.T + self.offsets)

    def parts(self, values: Mapping[str, float]) -> Array:
        """Return how far each statistic lowers or raises the log odds [S].

        Against a motion that is like this one but for having that statistic at the centre.
        """
        x = self.scaled(np.array([values[name] for name in self.names]))
        inward = self.weights @ x + self.offsets
        without = inward - self.weights.T * x[:, None]
        return self._of_switches(inward[None]) - self._of_switches(without)

    def _of_switches(self, inward: Array) -> Array:
        return self.bias + (inward * expit(inward)) @ self.outward

    def worst(self, values: Mapping[str, float], count: int) -> list[str]:
        """Say which statistics speak most against a motion, and how real motion has them.

        Those outside the range of nearly all real motion come first.
        """
        x = np.array([values[name] for name in self.names])
        low, high = self.range
        beyond = (x < low) | (x > high)
        order = np.lexsort((self.parts(values), ~beyond))
        return [
            f"{self.names[n].replace('_', ' ')} is {x[n]:.3g}, "
            f"in real motion mostly {low[n]:.3g} to {high[n]:.3g}"
            for n in order[:count]
        ]

    def to_dict(self) -> dict[str, Any]:
        """Return what the JSON file holds."""
        rounded = {
            name: np.vectorize(lambda v: float(f"{v:.4g}"))(getattr(self, name)).tolist()
            for name in _ARRAYS
        }
        plain = ("bias", "marginal_below")
        return {"names": list(self.names), **rounded, **{n: getattr(self, n) for n in plain}}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> FittedScore:
        """Undo `to_dict`."""
        return cls(
            names=tuple(data["names"]),
            **{name: np.array(data[name]) for name in _ARRAYS},
            bias=float(data["bias"]),
            marginal_below=float(data["marginal_below"]),
        )


@cache
def fitted_score() -> FittedScore:
    """Return the shipped model."""
    return FittedScore.from_dict(json.loads(_FILE.read_text(encoding="utf-8"))["model"])
