"""`motiondiffuse replay`: plan again what was recorded, and compare bit for bit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console

from motiondiffuse_ros.cli.parsing import parse


@dataclass(frozen=True)
class Replay:
    """Plan again what an MCAP recording holds, and compare the trajectory bit for bit.

    Ends with 0 if it is the same, 1 if it is not, 2 if it cannot be planned again.
    """

    recording: Annotated[Path, tyro.conf.Positional]
    """MCAP file of `generate --record` or of the node's `record_dir`."""
    weights: Path | None = None
    """Folder of the recorded weights, if they lie elsewhere now."""
    text_encoder: Path | None = None
    """Folder of the recorded text encoder, if it lies elsewhere now."""
    out: Path | None = None
    """Folder for the files of the new plan; none if not given."""
    picture: bool = True
    """With --out: also draw motion.gif."""


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    options = parse(Replay, arguments, "replay")
    from motiondiffuse_ros.cli.planning import plan_with_bar, write_plan
    from motiondiffuse_ros.recording import difference, doubts, planner_of, read_recording, replay

    record = read_recording(options.recording)
    planner = planner_of(record, options.weights, options.text_encoder)
    console, problems = Console(soft_wrap=True), Console(stderr=True, soft_wrap=True)
    for doubt in doubts(record):
        problems.print(f"warning: {doubt}", highlight=False, markup=False)
    plan = plan_with_bar(console, lambda progress: replay(record, planner, progress))
    if options.out is not None:
        write_plan(console, plan, options.out, picture=options.picture)
    found = difference(record, plan.trajectory)
    if not found:
        console.print("the same trajectory bit for bit")
        return 0
    console.print(f"not the same trajectory: {found}", highlight=False, markup=False)
    if plan.candidate != record.candidate:
        console.print(f"candidate {plan.candidate} was chosen, then it was {record.candidate}")
    return 1
