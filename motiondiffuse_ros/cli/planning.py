"""What the commands that plan have in common: a bar, the files, a few lines on the result."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from motiondiffuse_ros.planner import Plan, Progress
from motiondiffuse_ros.render import render_skeleton


def plan_with_bar(console: Console, plan: Callable[[Callable[[Progress], None]], Plan]) -> Plan:
    """Call what plans with a function that shows its progress."""
    columns = (TextColumn("{task.description:>12}"), BarColumn(), TimeElapsedColumn())
    with Bar(*columns, console=console, transient=True) as bar:
        task = bar.add_task("text", total=1.0)
        return plan(lambda p: bar.update(task, description=p.stage, completed=p.fraction))


def write_plan(console: Console, plan: Plan, folder: Path, *, picture: bool) -> None:
    """Write a plan's files, and say what became of it."""
    plan.save(folder)
    if picture:
        title = " · ".join(s.text for s in plan.request.segments)
        render_skeleton([plan.motion], folder / "motion.gif", titles=[title])
    report = plan.report
    console.print(
        f"{report.verdict} (score {report.score:.2f}), seed {plan.seed}, "
        f"{plan.trajectory.duration:.1f} s, planned in {plan.timings_s['total']:.1f} s"
    )
    for reason in (*report.reasons, *plan.trajectory.notes):
        console.print(f"  {reason}", highlight=False, markup=False)
    console.print(f"written to {folder}")
