"""`motiondiffuse check`: what physics says about a motion file, ours or anyone's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.motion_file import read_motion

if TYPE_CHECKING:
    from motiondiffuse_ros.motion import Motion
    from motiondiffuse_ros.physics import Report

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
    series: Path | None = None
    """Also write every measure frame by frame here, as NPZ."""
    picture: Path | None = None
    """Also draw contacts, errors and balance over time here, as PNG."""
    pd: bool = True
    """Also simulate the motion under a PD controller, which has no balance; quick."""
    track: bool = False
    """Also execute the motion without assistance, by sampling; takes several times its duration."""
    executed: Path | None = None
    """Folder for what `--track` executed (executed.npz, executed.bvh, forces.npz, execution.json,
    and a film beside the reference); FILE's name with _executed if not given."""
    seed: int = 0
    """Of the tracking."""
    threads: int | None = None
    """Of the tracking; one a core if not given."""
    strict: bool = False
    """Exit with code 1 if the motion is implausible."""


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    return check(parse(Check, arguments, "check"))


def check(options: Check) -> int:
    """Print the verdict on a motion file and write the report.

    Returns:
        0, or 1 for an implausible motion if `strict`.

    Raises:
        MotionFileError: If the file cannot be read as a motion.
        PhysicsError: If the motion is too short or not finite and is to be tracked.
        RobotError: If there is no such robot.
    """
    from motiondiffuse_ros.physics import assess
    from motiondiffuse_ros.render.verdict_sheet import draw_verdict
    from motiondiffuse_ros.robots import get_robot

    limits = get_robot(options.robot)
    motion = read_motion(options.file)
    console = Console()
    columns = (TextColumn("{task.description:>12}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("physics", total=1.0)
        report = assess(
            motion,
            robot=limits if limits.is_canonical else None,
            track=options.pd,
            progress=lambda share: bar.update(task, completed=share),
        )
        if options.track:
            task = bar.add_task("tracking", total=1.0)
            report = _execute(
                motion, report, options, lambda share: bar.update(task, completed=share)
            )
    frames = f"{motion.frames} frames, {motion.duration:.1f} s"
    console.print(f"{options.file}: {frames}", highlight=False)
    console.print(_table(report.metrics))
    verdict = f"[{_COLOURS[report.verdict]}]{report.verdict}[/] (score {report.score:.2f})"
    console.print(verdict, highlight=False)
    for reason in report.reasons:
        console.print(f"  {reason}", highlight=False, markup=False)
    if options.track:
        console.print(f"executed motion written to {_folder(options)}", highlight=False)
    writers: tuple[tuple[Path | None, Callable[[Path], None]], ...] = (
        (options.out, report.save),
        (options.series, report.save_series),
        (options.picture, lambda path: draw_verdict(report, path, options.file.name)),
    )
    for path, write in writers:
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            write(path)
            console.print(f"written to {path}", highlight=False)
    return 1 if options.strict and report.verdict == "implausible" else 0


def _execute(
    motion: Motion, report: Report, options: Check, progress: Callable[[float], None]
) -> Report:
    """Track a motion, leave the files, and return the report with its figures."""
    from motiondiffuse_ros.execution import with_execution
    from motiondiffuse_ros.physics.tracking import SamplingConfig, track_by_sampling
    from motiondiffuse_ros.render.tracking_film import render_tracking

    config = SamplingConfig(seed=options.seed, threads=options.threads)
    execution = track_by_sampling(motion, config, progress=progress)
    execution.save(_folder(options))
    render_tracking(motion, execution.motion, _folder(options) / "tracking")
    return with_execution(report, execution)


def _folder(options: Check) -> Path:
    return options.executed or Path(f"{options.file.stem}_executed")


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
