"""`motiondiffuse check`: what physics says about a motion file, ours or anyone's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.motion_file import read_motion

_COLOURS = {"plausible": "green", "marginal": "yellow", "implausible": "red"}


@dataclass(frozen=True)
class Check:
    """Judge a motion by physics: plausible, marginal or implausible, with reasons and figures.

    The definitions of the figures and how the thresholds were set are in docs/physics.md.
    """

    file: Annotated[Path, tyro.conf.Positional]
    """A BVH file of a known skeleton, or a motion.npz of this package."""
    robot: str = "humanoid"
    """Whose joint limits count; the humanoid's where its joints are others."""
    out: Path | None = None
    """Also write the report here, as JSON."""
    track: bool = True
    """Also simulate the motion under a PD controller."""
    strict: bool = False
    """Exit with code 1 if the motion is implausible."""


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    options = parse(Check, arguments, "check")
    return check(
        options.file,
        options.robot,
        options.out,
        track=options.track,
        strict=options.strict,
    )


def check(
    file: Path,
    robot: str = "humanoid",
    out: Path | None = None,
    *,
    track: bool = True,
    strict: bool = False,
) -> int:
    """Print the verdict on a motion file and write the report.

    Returns:
        0, or 1 for an implausible motion if `strict`.

    Raises:
        MotionFileError: If the file cannot be read as a motion.
        RobotError: If there is no such robot.
    """
    from motiondiffuse_ros.physics import assess
    from motiondiffuse_ros.robots import get_robot

    limits = get_robot(robot)
    motion = read_motion(file)
    console = Console()
    columns = (TextColumn("{task.description:>12}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("physics", total=1.0)
        report = assess(
            motion,
            robot=limits if limits.is_canonical else None,
            track=track,
            progress=lambda share: bar.update(task, completed=share),
        )
    console.print(f"{file}: {motion.frames} frames, {motion.duration:.1f} s", highlight=False)
    console.print(_table(report.metrics))
    verdict = f"[{_COLOURS[report.verdict]}]{report.verdict}[/] (score {report.score:.2f})"
    console.print(verdict, highlight=False)
    for reason in report.reasons:
        console.print(f"  {reason}", highlight=False, markup=False)
    if out is not None:
        out.parent.mkdir(parents=True, exist_ok=True)
        report.save(out)
        console.print(f"written to {out}", highlight=False)
    return 1 if strict and report.verdict == "implausible" else 0


def _table(metrics: dict[str, float | None]) -> Table:
    from motiondiffuse_ros.physics.criteria import CRITERIA

    thresholds = {criterion.name: criterion for criterion in CRITERIA}
    table = Table("metric", "value", "marginal above", "implausible above", box=None)
    for name, value in metrics.items():
        criterion = thresholds.get(name)
        limits = ("", "") if criterion is None else (criterion.marginal, criterion.implausible)
        shown = "not computed" if value is None else f"{value:.3g}"
        if criterion is not None and value is not None and value > criterion.marginal:
            shown = f"[{'red' if value > criterion.implausible else 'yellow'}]{shown}[/]"
        table.add_row(name, shown, *map(str, limits))
    return table
