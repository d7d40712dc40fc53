"""`motiondiffuse generate`: words or a request file to files a robot can follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import time_ns
from typing import Annotated
from uuid import uuid4

import tyro
from rich.console import Console

from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.edit import Edit, parse_spans
from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.motion_file import read_motion
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.waypoint import parse_waypoint


@dataclass(frozen=True)
class Generate:
    """Sample a motion from text, check it, and write it as a joint trajectory.

    Leaves in the output folder: plan.json, report.json, motion.bvh, motion.npz, trajectory.csv,
    root.csv, motion.gif, and for whole-body trackers tracking.csv and tracking.npz.
    """

    text: Annotated[str | None, tyro.conf.Positional] = None
    """What to do, in plain English, or "[0-4] walk ahead | right_arm[2-4]: wave"; or --request."""
    request: Path | None = None
    """YAML file with timed segments and body parts."""
    seconds: float | None = None
    """Length of the motion [s]; 6 or, of a text with times, the end of the last."""
    waypoints: tuple[str, ...] = ()
    """Places of the root, each "TIME,X,Y" or "TIME,X,Y,HEADING": s, m ahead, m to the left, rad."""
    edit: Path | None = None
    """Motion (.npz or .bvh) of which a part is kept; the text says what becomes of the rest."""
    regenerate: tuple[str, ...] = ()
    """With --edit: body parts made anew; the others are kept."""
    keep_frames: str | None = None
    """With --edit: spans of time kept whole, as 0-1.5,4-6 [s]."""
    seed: int | None = None
    """Of all randomness; drawn and recorded if not given."""
    candidates: int | None = None
    """Motions to choose the most plausible from."""
    steps: int | None = None
    """Denoising steps."""
    guidance_scale: float | None = None
    """Weight of the text; 1 is none."""
    scheduler: str | None = None
    """ddim, ddpm or dpm-solver++; the last if not given."""
    robot: str | None = None
    """Robot to retarget to: humanoid, g1, or a description file (docs/robots.md)."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    text_encoder: Path | None = None
    """Folder of CLIP's files, for weights trained with it."""
    rate: float = 50.0
    """Points of the trajectory a second."""
    track: bool = True
    """Also simulate the motion under a PD controller."""
    execution: str = "none"
    """Execute the plan without assistance in simulation: none, verify, or publish_executed."""
    picture: bool = True
    """Also draw motion.gif."""
    record: Path | None = None
    """Also record the plan in this MCAP file, for Foxglove and `motiondiffuse replay`."""
    out: Path = Path("out")
    """Folder for the results."""


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    options = parse(Generate, arguments, "generate")
    request = _request(options)
    request.validate()
    # torch loads after the request has been found good
    from motiondiffuse_ros.cli.planning import plan_with_bar, write_plan
    from motiondiffuse_ros.planner import Planner, PlannerConfig
    from motiondiffuse_ros.robots import get_robot

    get_robot(request.robot)
    defaults = PlannerConfig()
    planner = Planner(
        PlannerConfig(
            weights=options.weights,
            text_encoder=options.text_encoder,
            scheduler=options.scheduler or defaults.scheduler,
            steps=request.steps or defaults.steps,
            control_rate=options.rate,
            track=options.track,
            execution=options.execution,
        )
    )
    console = Console()
    plan = plan_with_bar(console, lambda progress: planner.plan(request, progress=progress))
    write_plan(console, plan, options.out, picture=options.picture)
    if options.record is not None:
        from motiondiffuse_ros.ros.plan_recorder import record_without_node

        record_without_node(options.record, planner, plan, str(uuid4()), time_ns())
        console.print(f"recorded in {options.record}")
    return 0


def _request(options: Generate) -> MotionRequest:
    if (options.text is None) == (options.request is None):
        raise RequestError("give either a text or --request FILE")
    if options.request is not None:
        if options.seconds is not None:
            raise RequestError("--seconds goes with a text; a request file has its own duration")
        request = MotionRequest.from_yaml(options.request)
    else:
        assert options.text is not None
        if options.seconds is not None and not math.isfinite(options.seconds):
            raise RequestError(f"--seconds must be a finite number, got {options.seconds}")
        seconds = options.seconds
        if seconds is None and options.edit is not None:
            seconds = read_motion(options.edit).duration
        request = MotionRequest.from_text(options.text, seconds)
    if options.waypoints:
        request = replace(request, waypoints=tuple(map(parse_waypoint, options.waypoints)))
    if options.edit is not None:
        spans = () if options.keep_frames is None else parse_spans(options.keep_frames)
        request = replace(request, edit=Edit(str(options.edit), options.regenerate, spans))
    elif options.regenerate or options.keep_frames is not None:
        raise RequestError("--regenerate and --keep-frames go with --edit FILE")
    names = ("seed", "candidates", "steps", "guidance_scale", "robot")
    given = {name: getattr(options, name) for name in names}
    return replace(request, **{name: value for name, value in given.items() if value is not None})
