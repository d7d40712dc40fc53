"""Draw what becomes of motions on a robot: the sheet and the film of docs/robots.md.

    python -m benchmarks.g1_sheet [--robot g1] [--sheet docs/g1.png] [--film docs/g1.gif]

Each prompt is sampled, drawn as the skeleton, and below it rendered as the robot at the same times.
The film shows the last prompt. MuJoCo renders, so this needs EGL or OSMesa.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro
from PIL import Image
from rich.progress import track

from benchmarks.g1 import RATE, states
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.planner import Plan, Planner, PlannerConfig
from motiondiffuse_ros.render import contact_sheet
from motiondiffuse_ros.render.mujoco_renderer import render_qpos, render_states
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import get_robot

COLUMNS = 8

_ZOOM = 1.6  # robots are smaller than the skeleton


@dataclass(frozen=True)
class Options:
    """What to draw."""

    prompts: tuple[str, ...] = (
        "a person raises both hands",
        "a person bows",
        "a person kicks with the right leg",
        "a person sits down",
        "a person walks forward and waves",
    )
    """One strip each."""
    robot: str = "g1"
    """Name or description file."""
    seconds: float = 5.0
    """Length of each [s]."""
    seed: int = 0
    """Of all motions."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    sheet: Path = Path("docs/g1.png")
    """The sheet."""
    film: Path = Path("docs/g1.gif")
    """The film."""


def main() -> None:
    """Sample, render and write."""
    options = tyro.cli(Options)
    robot = get_robot(options.robot)
    planner = Planner(PlannerConfig(weights=options.weights, track=False))
    requests = [
        MotionRequest.from_text(text, options.seconds, seed=options.seed, robot=options.robot)
        for text in options.prompts
    ]
    plans = [planner.plan(request) for request in track(requests, "planning")]
    strips = []
    for text, plan in zip(options.prompts, plans, strict=True):
        drawn = _skeleton(text, plan.motion)
        width = drawn.width // COLUMNS
        strips += [drawn, _robot(plan, width, drawn.height)]
    sheet = Image.new("RGB", (strips[0].width, sum(strip.height for strip in strips)))
    top = 0
    for strip in strips:
        sheet.paste(strip, (0, top))
        top += strip.height
    options.sheet.parent.mkdir(parents=True, exist_ok=True)
    sheet.quantize(128).save(options.sheet, optimize=True)
    render_qpos(robot.model, states(plans[-1].trajectory), RATE, options.film, size=(320, 320))


def _skeleton(text: str, motion: Motion) -> Image.Image:
    with tempfile.TemporaryDirectory() as folder:
        path = contact_sheet([(text, motion)], Path(folder) / "row.png", columns=COLUMNS)
        with Image.open(path) as picture:
            return picture.convert("RGB")


def _robot(plan: Plan, width: int, height: int) -> Image.Image:
    """Return one row of pictures, the robot in the middle of each."""
    qpos: Array = states(plan.trajectory)
    shown = qpos[np.linspace(0, len(qpos) - 1, COLUMNS).round().astype(int)]
    shown[:, :2] = 0.0
    size = round(_ZOOM * width), round(_ZOOM * height)
    pictures = render_states(get_robot(plan.robot).model, shown, size)
    left, top = (size[0] - width) // 2, round(0.55 * (size[1] - height))
    cut = pictures[:, top : top + height, left : left + width]
    return Image.fromarray(np.concatenate(list(cut), axis=1))


if __name__ == "__main__":
    main()
