"""The physics report: a verdict with reasons, and the figures behind it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from motiondiffuse_ros.errors import Cancelled
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.body_states import Limits, humanoid_states
from motiondiffuse_ros.physics.criteria import CRITERIA
from motiondiffuse_ros.physics.dynamics import state_dynamics
from motiondiffuse_ros.physics.fitted_score import fitted_score
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.measures import MIN_FRAMES, RATE, Series, measure
from motiondiffuse_ros.physics.statistics import statistics
from motiondiffuse_ros.physics.tracking import track

_STATISTICS_NAMED = 2
_PASSING_FRAMES = 5
_ASSESSED = 0.2  # share of the work that is done before the simulation

PLAUSIBLE, MARGINAL, IMPLAUSIBLE = "plausible", "marginal", "implausible"

METRICS = (
    *("penetrate_mm", "float_mm", "skate_mm", "phys_err_mm", "skating_ratio"),
    *("contact_skating_ratio", "joint_limit_violation", "joint_velocity_violation", "peak_jerk"),
    *("root_residual_force_bw", "root_residual_torque", "torque_violation"),
    *("time_to_fall_s", "tracking_mpjpe_mm"),
)
"""The keys that every report has, null where not computed. docs/physics.md defines each."""


class TimedText(Protocol):
    """A segment of a request."""

    @property
    def text(self) -> str: ...

    @property
    def start(self) -> float: ...

    @property
    def end(self) -> float: ...

    @property
    def parts(self) -> tuple[str, ...]: ...


@dataclass(frozen=True)
class SegmentReport:
    """The verdict on the frames of one segment of the request.

    Attributes:
        text: Of the segment.
        start: s.
        end: s.
        parts: Body parts, none for the whole body.
        verdict: plausible, marginal or implausible.
        reasons: What is wrong, how much and when.
        metrics: The statistics that were judged.
    """

    text: str
    start: float
    end: float
    parts: tuple[str, ...]
    verdict: str
    reasons: tuple[str, ...]
    metrics: dict[str, float] = field(repr=False)


@dataclass(frozen=True)
class Report:
    """What physics says about a motion.

    Attributes:
        verdict: plausible, marginal or implausible.
        reasons: What is wrong, how much and when; empty for a plausible motion.
        score: 0 to 1, higher is more plausible; continuous, for choosing among candidates.
        metrics: `METRICS` and more, None where not computed.
        segments: The same for each segment of the request.
        before_repair: Metrics of the motion before it was repaired; None if it was not.
        series: Every measure frame by frame at 20 Hz (`measures.measure`).
    """

    verdict: str
    reasons: tuple[str, ...]
    score: float
    metrics: dict[str, float | None] = field(repr=False)
    segments: tuple[SegmentReport, ...] = ()
    before_repair: dict[str, float | None] | None = field(default=None, repr=False)
    series: Mapping[str, Series] = field(default_factory=dict, repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Return what `report.json` holds: everything but the series."""
        return asdict(replace(self, series={})) | {"series": sorted(self.series)}

    def save(self, path: Path) -> None:
        """Write `report.json`."""
        path.write_text(json.dumps(self.to_dict(), indent=2) + "\n", encoding="utf-8")

    def save_series(self, path: Path) -> None:
        """Write the series as NPZ: `time` [s], and each measure by name, NaN where undefined."""
        frames = max((len(s.values) for s in self.series.values()), default=0)
        arrays = {name: series.values for name, series in self.series.items()}
        np.savez_compressed(path, allow_pickle=False, time=np.arange(frames) / RATE, **arrays)


def assess(
    motion: Motion,
    *,
    segments: Sequence[TimedText] = (),
    robot: Limits | None = None,
    track: bool = True,
    cancelled: Callable[[], bool] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Report:
    """Judge a motion on a floor at z = 0.

    Args:
        motion: At any rate. One that is not finite or too short is implausible, with the reason.
        segments: Spans of time to be judged on their own as well.
        robot: Whose joint limits count, if its joints are the 63 hinges; the humanoid's if None.
        track: Also simulate it under a PD controller (`tracking.track`); the slow part.
        cancelled: Asked between the steps of the work.
        progress: Told the share done, 0 to 1.

    Raises:
        Cancelled: If `cancelled` says so.
    """
    if not (np.isfinite(motion.root).all() and np.isfinite(motion.rotations).all()):
        return unjudged("the motion holds values that are not finite")
    sampled = motion.resample(RATE)
    if sampled.frames < MIN_FRAMES:
        return unjudged(
            f"the motion lasts {motion.duration:.2f} s; "
            f"dynamics need {(MIN_FRAMES - 1) / RATE:.2f} s or more"
        )
    _check(cancelled)
    states = humanoid_states(sampled, robot or hinge_table())
    dynamics = state_dynamics(states)
    _check(cancelled)
    measures = measure(states, dynamics)
    _check(cancelled)
    report = with_fitted_score(
        report_on(measures, segments), statistics(sampled, states, dynamics), sampled.duration
    )
    _check(cancelled)
    if progress is not None:
        progress(_ASSESSED if track else 1.0)
    if not track:
        return report
    rest = None if progress is None else lambda x: progress(_ASSESSED + (1.0 - _ASSESSED) * x)
    return with_tracking(report, motion, cancelled=cancelled, progress=rest)


def report_on(measures: Mapping[str, Series], segments: Sequence[TimedText] = ()) -> Report:
    """Put the measures of any body into a report by the criteria alone."""
    values, verdict, reasons = judge(measures)
    metrics: dict[str, float | None] = dict.fromkeys(METRICS)
    return Report(
        verdict=verdict,
        reasons=reasons,
        score=_score(values),
        metrics=metrics | _plain_metrics(measures) | values,
        segments=tuple(_segment(segment, measures) for segment in segments),
        series=measures,
    )


def with_fitted_score(report: Report, figures: Mapping[str, float], seconds: float) -> Report:
    """Join what the criteria say with the score fitted to real and broken clips.

    Args:
        report: By the criteria alone.
        figures: The motion's `statistics`.
        seconds: Duration of the motion, for the reasons.
    """
    model = fitted_score()
    likely = model.score(figures)
    metrics = {**report.metrics, "criteria_score": report.score, "fitted_score": likely}
    verdict, reasons = report.verdict, report.reasons
    if likely < model.marginal_below:
        told = model.worst(figures, _STATISTICS_NAMED)
        statistical = (f"{words} at 0.0-{seconds:.1f} s" for words in told)
        reasons = (*(reasons or _passing_faults(report.series)), *statistical)
        # unlike the clips it was fitted to is not yet against physics: only criteria condemn
        verdict = verdict if verdict == IMPLAUSIBLE else MARGINAL
    score = _joined(report.score, likely)
    return replace(report, verdict=verdict, reasons=reasons, score=score, metrics=metrics)


def with_tracking(
    report: Report,
    motion: Motion,
    *,
    cancelled: Callable[[], bool] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Report:
    """Add to a motion's report what its simulation under a PD controller shows.

    Raises:
        Cancelled: If `cancelled` says so.
    """
    tracking = track(motion, cancelled=cancelled, progress=progress)
    metrics = {
        **report.metrics,
        "time_to_fall_s": tracking.time_to_fall,
        "tracking_mpjpe_mm": tracking.mpjpe,
    }
    if not tracking.diverged:
        return replace(report, metrics=metrics)
    reason = f"its simulation diverged at {tracking.time_to_fall:.2f} s"
    return replace(report, metrics=metrics, verdict=IMPLAUSIBLE, reasons=(*report.reasons, reason))


def judge(
    measures: Mapping[str, Series], start: float = 0.0
) -> tuple[dict[str, float], str, tuple[str, ...]]:
    """Apply all criteria to some frames.

    Args:
        measures: Series of the same frames.
        start: Time of the first frame [s], for the reasons.

    Returns:
        The statistic of each criterion, the verdict, and the reasons.
    """
    values = {criterion.name: criterion.value(measures) for criterion in CRITERIA}
    broken = [c for c in CRITERIA if values[c.name] > c.marginal]
    implausible = any(values[c.name] > c.implausible for c in broken)
    verdict = IMPLAUSIBLE if implausible else MARGINAL if broken else PLAUSIBLE
    # worst first; criteria that share their words say the same thing twice
    broken.sort(key=lambda c: -values[c.name] / c.implausible)
    reasons = {c.words: c.reason(measures, start) for c in reversed(broken)}
    return values, verdict, tuple(reversed(reasons.values()))


def _segment(segment: TimedText, measures: Mapping[str, Series]) -> SegmentReport:
    first, last = round(segment.start * RATE), round(segment.end * RATE) + 1
    inside = {name: series.cut(first, last) for name, series in measures.items()}
    values, verdict, reasons = judge(inside, first / RATE)
    return SegmentReport(
        text=segment.text,
        start=segment.start,
        end=segment.end,
        parts=tuple(segment.parts),
        verdict=verdict,
        reasons=reasons,
        metrics=values,
    )


def _plain_metrics(measures: Mapping[str, Series]) -> dict[str, float | None]:
    means = {
        "penetrate_mm": "penetrate",
        "float_mm": "float",
        "skate_mm": "skate",
        "phys_err_mm": "phys_err",
    }
    out: dict[str, float | None] = {
        key: float(np.mean(measures[name].values)) for key, name in means.items()
    }
    balance = {"off_support_mm": "balance", "off_next_step_mm": "next_step"}
    for key, name in balance.items():
        out[key] = float(np.mean(np.nan_to_num(measures[name].values)))
    out["peak_power_w"] = float(np.nanmax(measures["power"].values))
    out["self_collision"] = float(np.mean(measures["self_collision"].values > 0.0))
    skates = measures["skates"].values[:-1]
    out["skating_ratio"] = float(np.mean(np.nan_to_num(skates)))
    out["mean_jerk"] = float(np.nanmean(measures["jerk"].values))
    return out


def _score(values: Mapping[str, float]) -> float:
    """Map the criteria's shares of their implausible thresholds to (0, 1]: 0.5 at the threshold.

    The fourth power lets the worst criterion rule while the others still count.
    """
    shares = np.array([values[c.name] / c.implausible for c in CRITERIA])
    return float(1.0 / (1.0 + np.sqrt(np.sum(shares**4))))


def _passing_faults(measures: Mapping[str, Series]) -> tuple[str, ...]:
    """Return reasons for what is wrong for a while and goes under in a whole motion's means."""
    found = [(c.lasting(measures), c) for c in CRITERIA]
    reasons = {c.words: c.reason(measures, 0.0) for n, c in found if n >= _PASSING_FRAMES}
    return tuple(reasons.values())


def _joined(by_criteria: float, fitted: float) -> float:
    """Return the geometric mean: either one at zero is enough."""
    return float(np.sqrt(by_criteria * fitted))


def unjudged(reason: str) -> Report:
    """Return the report on what cannot be judged: implausible."""
    return Report(IMPLAUSIBLE, (reason,), 0.0, dict.fromkeys(METRICS))


def _check(cancelled: Callable[[], bool] | None) -> None:
    if cancelled is not None and cancelled():
        raise Cancelled("the physics report was cancelled")
