"""A planned motion executed in simulation before it is published, or instead of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.report import IMPLAUSIBLE, MARGINAL, Report
from motiondiffuse_ros.physics.tracking import Execution, SamplingConfig, track_by_sampling

NONE, VERIFY, PUBLISH_EXECUTED = EXECUTIONS = ("none", "verify", "publish_executed")
"""What the planner does: nothing, report how execution ends, or also publish what was executed."""


def execute(
    motion: Motion,
    report: Report,
    *,
    publish: bool,
    judge: Callable[[Motion], Report],
    sampling: SamplingConfig | None = None,
    cancelled: Callable[[], bool] | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Motion, Report]:
    """Execute a motion without assistance.

    Args:
        motion: As planned.
        report: On it.
        publish: Return the executed motion, if it came to its end.
        judge: Makes the report of that.
        sampling: How the tracking samples; None is the default way.
        cancelled: Asked before every plan of the tracking.
        progress: Told the share done, 0 to 1.

    Returns:
        The planned or the executed motion, and the report on it with the figures of execution.

    Raises:
        PhysicsError: If the motion is too short or not finite.
        Cancelled: If `cancelled` says so.
    """
    execution = track_by_sampling(motion, sampling, cancelled=cancelled, progress=progress)
    if publish and execution.success:
        motion = execution.motion
        report = judge(motion)
    return motion, with_execution(report, execution)


def with_execution(report: Report, execution: Execution) -> Report:
    """Add the figures of an execution to a report; one that falls is marginal at best."""
    report = replace(report, metrics={**report.metrics, **execution.metrics()})
    if execution.success:
        return report
    reason = f"executed without assistance it falls at {execution.time_to_fall:.2f} s"
    return replace(
        report,
        verdict=IMPLAUSIBLE if report.verdict == IMPLAUSIBLE else MARGINAL,
        reasons=(*report.reasons, reason),
    )
