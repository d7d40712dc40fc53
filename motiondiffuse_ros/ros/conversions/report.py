"""Physics reports as `PlausibilityReport`."""

from __future__ import annotations

import math

from motiondiffuse_ros.msg import PlausibilityReport
from motiondiffuse_ros.physics.report import Report
from motiondiffuse_ros.ros.conversions.request import segment_to_message

_NOT_METRICS = {
    *("verdict", "reasons", "score"),
    *("segments", "segment_verdicts", "segment_reasons"),
}
METRICS = tuple(
    name for name in PlausibilityReport.get_fields_and_field_types() if name not in _NOT_METRICS
)
"""The metrics that the message carries, named as in report.json."""

VERDICTS = {
    "plausible": PlausibilityReport.PLAUSIBLE,
    "marginal": PlausibilityReport.MARGINAL,
    "implausible": PlausibilityReport.IMPLAUSIBLE,
}


def report_to_message(report: Report) -> PlausibilityReport:
    """Write a report; a metric that was not computed becomes NaN."""
    metrics = {name: report.metrics.get(name) for name in METRICS}
    return PlausibilityReport(
        verdict=VERDICTS[report.verdict],
        reasons=list(report.reasons),
        score=float(report.score),
        segments=[segment_to_message(segment) for segment in report.segments],
        segment_verdicts=[VERDICTS[segment.verdict] for segment in report.segments],
        segment_reasons=["; ".join(segment.reasons) for segment in report.segments],
        **{name: math.nan if value is None else float(value) for name, value in metrics.items()},
    )
