"""How smoothly does a new plan take over from the one that is executed?

    python -m benchmarks.continuity [--preemptions 50] [--steps 8] [--seed 0] [--json F]

A chain of plans: each takes over from the one before at a random time, half of them in time, half
up to a second late, as the node does it. At the seam the joints of the old and the new trajectory
are compared; around it the jerk of the set-points, and of the motion that was sampled.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from rich.table import Table

from motiondiffuse_ros.continuation import LEAD_IN, Start
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.planner import Plan, Planner, PlannerConfig
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState

TEXTS = (
    "a person walks forward",
    "a person waves with the right hand",
    "a person turns left",
    "a person runs",
    "a person bows",
    "a person raises both arms",
    "a person walks backward",
    "a person kicks with the left leg",
)
LATEST = 1.0
"""By which a plan may miss its seam [s]."""


@dataclass(frozen=True)
class Options:
    """What to run."""

    preemptions: int = 50
    """Plans that take over."""
    seconds: float = 4.0
    """Length of each motion [s]."""
    steps: int = 8
    """Denoising steps."""
    seed: int = 0
    """Of times and motions."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    json: Path | None = None
    """Where to write the figures."""


@dataclass(frozen=True)
class TakeOver:
    """What one seam looks like.

    Attributes:
        late_s: By how much the plan missed the seam it was made for.
        approach_s: How much longer the trajectory is than the motion.
        position_jump_deg: Largest difference of a joint between the trajectories at the seam.
        velocity_jump: Largest difference of a joint's speed there [rad/s].
        root_jump_mm: Distance of the roots there.
        pose_gap_deg: How far the motion's first pose is from that of the robot, worst joint; what
            the trajectory has to close.
        step_deg: Largest movement of a joint between two set-points at 50 Hz, in the first second.
    """

    late_s: float
    approach_s: float
    position_jump_deg: float
    velocity_jump: float
    root_jump_mm: float
    pose_gap_deg: float
    step_deg: float


def take_over(
    planner: Planner, old: Plan, text: str, seam: float, late: float, seconds: float, seed: int
) -> tuple[Plan, TakeOver]:
    """Plan from a seam of a running plan, and start the result as late as it is.

    Args:
        planner: Makes the plan.
        old: The plan that is executed.
        text: Of the new one.
        seam: Time of the old trajectory from which the new motion goes on [s].
        late: Time after the seam at which it starts [s].
        seconds: Length of the new motion [s].
        seed: Of the new motion.
    """
    running, robot = TrajectoryState(old.trajectory), get_robot(old.robot)
    lead_in = running.motion_up_to(robot, seam, LEAD_IN, planner.fps)
    request = MotionRequest.from_text(text, seconds, seed=seed)
    plan = planner.plan(request, start=Start(lead_in, running.at(seam)))
    if late > 0.0:
        plan = planner.restarted(plan, running.at(seam + late))
    here, new = running.at(seam + late), TrajectoryState(plan.trajectory)
    there = new.at(0.0)
    assert here.root is not None
    assert there.root is not None
    at_seam = running.motion_up_to(robot, seam + late, 0.0, planner.fps)
    gap = rot.angle_between(plan.motion.rotations[0, 1:], at_seam.rotations[0, 1:])
    first_second = [new.joints(t)[0] for t in np.arange(0.0, 1.0, 0.02)]
    return plan, TakeOver(
        late_s=late,
        approach_s=plan.trajectory.duration - plan.motion.duration,
        position_jump_deg=_worst(np.degrees(there.positions - here.positions)),
        velocity_jump=_worst(there.velocities - here.velocities),
        root_jump_mm=float(1e3 * np.linalg.norm(there.root.position - here.root.position)),
        pose_gap_deg=_worst(np.degrees(gap)),
        step_deg=_worst(np.degrees(np.diff(first_second, axis=0))),
    )


def main(options: Options) -> None:
    """Print the table and write the figures."""
    planner = Planner(
        PlannerConfig(
            weights=options.weights, steps=options.steps, candidates=1, track=False, settle=False
        )
    )
    rng = np.random.default_rng(options.seed)
    plan = planner.plan(MotionRequest.from_text(TEXTS[0], options.seconds, seed=options.seed))
    rows: list[TakeOver] = []
    for i in track(range(options.preemptions), "taking over"):
        seam = float(rng.uniform(0.1, plan.trajectory.duration))
        late = float(rng.uniform(0.0, LATEST)) if i % 2 else 0.0
        text = TEXTS[int(rng.integers(len(TEXTS)))]
        plan, row = take_over(planner, plan, text, seam, late, options.seconds, options.seed + i)
        rows.append(row)
    figures = {name: [getattr(row, name) for row in rows] for name in asdict(rows[0])}
    table = Table("figure", "median", "95 %", "worst", title=f"{len(rows)} preemptions", box=None)
    for name, values in figures.items():
        cells = (np.median(values), np.percentile(values, 95), np.max(values))
        table.add_row(name, *(f"{cell:.3g}" for cell in cells))
    Console().print(table)
    if options.json is not None:
        record = {
            "weights_sha256": planner.weights_sha256,
            "settings": {k: v for k, v in asdict(options).items() if k not in ("json", "weights")},
            "rows": [asdict(row) for row in rows],
        }
        options.json.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")


def _worst(values: np.ndarray) -> float:
    return float(np.abs(values).max())


if __name__ == "__main__":
    main(tyro.cli(Options, config=(tyro.conf.OmitArgPrefixes,)))
