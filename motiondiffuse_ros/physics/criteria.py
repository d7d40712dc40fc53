"""What makes a verdict: one statistic of one series each, two thresholds, and words.

The thresholds were set on real clips of both training sets against the same clips lifted, sunk,
slid, sped up, jittered and tilted; docs/physics.md has the table and the command that makes it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.spans import runs
from motiondiffuse_ros.physics.measures import RATE, Series

_SHORTEST_SPAN = 2
_BRIDGED_GAP = 3
_SPANS_NAMED = 2


@dataclass(frozen=True)
class Criterion:
    """One way for a motion to be wrong.

    Attributes:
        name: What `Report.metrics` calls the statistic.
        series: Which series it is taken of.
        statistic: Of the defined values of the series.
        marginal: Above this a motion is marginal at best.
        implausible: Above this it is implausible.
        words: The reason, with `{who}` and `{size}`, the size being the largest value.
        shown: The series that the reason's size and times come from.
        span_above: A frame belongs to the reason's times if `shown` is above this.
        scale: From the unit of `shown` to that of the words.
    """

    name: str
    series: str
    statistic: Callable[[Array], float]
    marginal: float
    implausible: float
    words: str
    shown: str
    span_above: float
    scale: float = 1.0

    def value(self, measures: Mapping[str, Series]) -> float:
        """Return the statistic; 0 where the series is defined nowhere."""
        values = measures[self.series].values
        defined = values[~np.isnan(values)]
        return float(self.statistic(defined)) if len(defined) else 0.0

    def lasting(self, measures: Mapping[str, Series]) -> int:
        """Return the frames of the longest span in which the shown series is too large."""
        values = np.nan_to_num(measures[self.shown].values)
        return max((b - a for a, b in _spans(values > self.span_above)), default=0)

    def reason(self, measures: Mapping[str, Series], start: float) -> str:
        """Say what is wrong, how much and when.

        Args:
            measures: The series that were judged.
            start: Time of their first frame [s].
        """
        series = measures[self.shown]
        values = np.nan_to_num(series.values)
        spans = _spans(values > self.span_above) or [(0, len(values))]
        spans.sort(key=lambda span: -values[span[0] : span[1]].sum())
        spans = sorted(spans[:_SPANS_NAMED])
        peak = max(
            (index for a, b in spans for index in range(a, b)), key=lambda index: values[index]
        )
        who = "the body" if series.who is None else series.who[peak].replace("_", " ")
        times = " and ".join(_times(start + a / RATE, start + b / RATE) for a, b in spans)
        return f"{self.words.format(who=who, size=self.scale * values[peak])} at {times} s"


def _share(values: Array) -> float:
    return float(np.mean(values > 0.0))


def _upper_decile(values: Array) -> float:
    return float(np.quantile(values, 0.9))


CRITERIA = (
    Criterion(
        "penetrate_mm",
        *("penetrate", np.mean, 9.0, 15.0),
        words="{who} goes {size:.0f} mm into the floor",
        shown="penetrate",
        span_above=15.0,
    ),
    Criterion(
        "hover_mm",
        *("float", np.median, 16.0, 30.0),
        words="{who} hovers {size:.0f} mm above the floor",
        shown="float",
        span_above=16.0,
    ),
    Criterion(
        "root_residual_force_bw",
        *("residual_force", np.mean, 0.2, 0.4),
        words="{size:.0%} of {who}'s weight is carried by nothing",
        shown="residual_force",
        span_above=0.3,
    ),
    Criterion(
        "root_residual_force_median_bw",
        *("residual_force", np.median, 0.1, 0.25),
        words="{size:.0%} of {who}'s weight is carried by nothing",
        shown="residual_force",
        span_above=0.1,
    ),
    Criterion(
        "root_residual_torque",
        *("residual_torque", np.mean, 0.09, 0.13),
        words="{who} is out of balance by {size:.2f} body weights times metre",
        shown="residual_torque",
        span_above=0.1,
    ),
    Criterion(
        "contact_skating_ratio",
        *("skates", np.mean, 0.3, 0.42),
        words="{who} slides {size:.1f} m/s",
        shown="support_slide",
        span_above=0.3,
    ),
    Criterion(
        "support_slide_mps",
        *("support_slide", np.median, 0.15, 0.28),
        words="{who} slides {size:.1f} m/s",
        shown="support_slide",
        span_above=0.3,
    ),
    Criterion(
        "median_jerk",
        *("jerk", np.median, 800.0, 1300.0),
        words="{who} jerks with {size:.0f} m/s^3",
        shown="jerk",
        span_above=1000.0,
    ),
    Criterion(
        "upper_decile_jerk",
        *("jerk", _upper_decile, 1350.0, 2200.0),
        words="{who} jerks with {size:.0f} m/s^3",
        shown="jerk",
        span_above=1500.0,
    ),
    Criterion(
        "peak_jerk",
        *("jerk", np.max, 4000.0, 8000.0),
        words="{who} jerks with {size:.0f} m/s^3",
        shown="jerk",
        span_above=3000.0,
    ),
    Criterion(
        "joint_limit_violation",
        *("range_excess", _share, 0.12, 0.4),
        words="{who} is {size:.0f} degrees beyond its range",
        shown="range_excess",
        span_above=0.0,
        scale=float(np.degrees(1.0)),
    ),
    Criterion(
        "joint_velocity_violation",
        *("speed_excess", _share, 0.01, 0.05),
        words="{who} turns {size:.1f} rad/s faster than its limit",
        shown="speed_excess",
        span_above=0.0,
    ),
    Criterion(
        "torque_violation",
        *("torque_excess", _share, 0.06, 0.25),
        words="{who} would need {size:.0f} N m more than its limit",
        shown="torque_excess",
        span_above=0.0,
    ),
)


def _times(start: float, end: float) -> str:
    """Round outwards to tenths of a second."""
    return f"{np.floor(10 * start + 1e-6) / 10:.1f}-{np.ceil(10 * end - 1e-6) / 10:.1f}"


def _spans(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the runs of True as (start, stop), short gaps bridged, single frames left out."""
    bridged: list[tuple[int, int]] = []
    for a, b in runs(flags):
        if bridged and a - bridged[-1][1] <= _BRIDGED_GAP:
            bridged[-1] = (bridged[-1][0], b)
        else:
            bridged.append((a, b))
    return [(a, b) for a, b in bridged if b - a >= _SHORTEST_SPAN]
