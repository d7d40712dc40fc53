"""Does the root pass its waypoints, and what does that cost the feet?

    python -m benchmarks.waypoints [--requests 50] [--seed 0] [--json F]

Each request asks for a gait along a random arc: two or three waypoints at random times, half of
them with a heading, at a speed that suits the gait. The same text and seed are sampled once with
the waypoints and once without; neither is repaired, which plans with waypoints never are.
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

from motiondiffuse_ros.physics.ground_contact import ground_errors
from motiondiffuse_ros.planner import Plan, Planner, PlannerConfig
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.waypoint import Waypoint

GAITS: dict[str, tuple[float, float]] = {
    "a person walks forward": (0.6, 1.4),
    "a person walks slowly": (0.4, 0.8),
    "a person walks while waving the right hand": (0.6, 1.2),
    "a person runs forward": (1.8, 3.0),
}
"""Texts and the speeds between waypoints, m/s."""
SHARPEST = 0.5
"""How fast the arcs turn at most [rad/s]."""
NEAR, STRAIGHT = 0.15, 15.0
"""A waypoint is met within this [m] and, where it has a heading, this [degrees]."""


@dataclass(frozen=True)
class Options:
    """What to run."""

    requests: int = 50
    """Requests with waypoints."""
    seconds: float = 6.0
    """Length of each motion [s]."""
    candidates: int = 1
    """Motions to choose from."""
    seed: int = 0
    """Of waypoints and motions."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    json: Path | None = None
    """Where to write the figures."""


@dataclass(frozen=True)
class Passed:
    """What became of one request.

    Attributes:
        text: Of the request.
        distance_m: Greatest distance of the motion's root from a waypoint at its time.
        trajectory_distance_m: The same of the trajectory's root.
        heading_deg: Greatest difference from a waypoint's heading; 0 where none has one.
        free_distance_m: Greatest distance of the motion without waypoints.
        phys_err_mm: Of the motion with waypoints.
        free_phys_err_mm: Of the motion without.
    """

    text: str
    distance_m: float
    trajectory_distance_m: float
    heading_deg: float
    free_distance_m: float
    phys_err_mm: float
    free_phys_err_mm: float

    @property
    def met(self) -> bool:
        """Whether every waypoint is met."""
        return max(self.distance_m, self.trajectory_distance_m) <= NEAR and (
            self.heading_deg <= STRAIGHT
        )


def arc(
    rng: np.random.Generator, seconds: float, speeds: tuple[float, float]
) -> tuple[Waypoint, ...]:
    """Draw waypoints on an arc that starts at the origin along x."""
    speed, turn = rng.uniform(*speeds), rng.uniform(-SHARPEST, SHARPEST)
    count, with_heading = int(rng.integers(2, 4)), rng.random() < 0.5
    times = np.linspace(0.0, seconds, count + 1)[1:] - rng.uniform(0.0, 0.4, count)
    points = []
    for time in times.tolist():
        half = 0.5 * turn * time
        chord = speed * time * np.sinc(half / np.pi)
        x, y = chord * np.cos(half), chord * np.sin(half)
        points.append(Waypoint(time, float(x), float(y), turn * time if with_heading else None))
    return tuple(points)


def measure(plan: Plan, free: Plan, waypoints: tuple[Waypoint, ...], text: str) -> Passed:
    """Compare a plan with its waypoints and with the plan that had none."""

    def distance(root: np.ndarray, times: np.ndarray) -> float:
        at = [int(np.abs(times - w.time).argmin()) for w in waypoints]
        places = np.array([(w.x, w.y) for w in waypoints])
        return float(np.linalg.norm(root[at, :2] - places, axis=1).max())

    times = np.arange(plan.motion.frames) / plan.motion.fps
    headings = [
        abs(
            np.angle(
                np.exp(1j * (plan.motion.heading[np.abs(times - w.time).argmin()] - w.heading))
            )
        )
        for w in waypoints
        if w.heading is not None
    ]
    return Passed(
        text=text,
        distance_m=distance(plan.motion.root, times),
        trajectory_distance_m=distance(plan.trajectory.root_position, plan.trajectory.times),
        heading_deg=float(np.degrees(max(headings, default=0.0))),
        free_distance_m=distance(free.motion.root, times),
        phys_err_mm=float(ground_errors(plan.motion).phys_err.mean()),
        free_phys_err_mm=float(ground_errors(free.motion).phys_err.mean()),
    )


def main(options: Options) -> None:
    """Print the table and write the figures."""
    planner = Planner(
        PlannerConfig(
            weights=options.weights, candidates=options.candidates, track=False, repair=False
        )
    )
    rng = np.random.default_rng(options.seed)
    rows: list[Passed] = []
    for i in track(range(options.requests), "requests"):
        text, speeds = list(GAITS.items())[i % len(GAITS)]
        waypoints = arc(rng, options.seconds, speeds)
        seed = options.seed + i
        free, plan = (
            planner.plan(MotionRequest.from_text(text, options.seconds, seed=seed, waypoints=w))
            for w in ((), waypoints)
        )
        rows.append(measure(plan, free, waypoints, text))
    table = Table("text", "met", "distance m", "heading °", "free m", "phys-err mm", "free mm")
    for name in (*GAITS, "all"):
        own = [row for row in rows if name in ("all", row.text)]
        if own:
            table.add_row(name, *_cells(own))
    Console().print(table)
    if options.json is not None:
        record = {
            "weights_sha256": planner.weights_sha256,
            "settings": {k: v for k, v in asdict(options).items() if k not in ("json", "weights")},
            "rows": [asdict(row) | {"met": row.met} for row in rows],
        }
        options.json.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")


def _cells(rows: list[Passed]) -> list[str]:
    worst = max(max(row.distance_m, row.trajectory_distance_m) for row in rows)
    constrained, free = (
        float(np.mean([getattr(row, name) for row in rows]))
        for name in ("phys_err_mm", "free_phys_err_mm")
    )
    return [
        f"{sum(row.met for row in rows)} of {len(rows)}",
        f"{worst:.3f} worst",
        f"{max(row.heading_deg for row in rows):.1f} worst",
        f"{np.median([row.free_distance_m for row in rows]):.2f} median",
        f"{constrained:.1f} ({constrained / free:.2f} of free)",
        f"{free:.1f}",
    ]


if __name__ == "__main__":
    main(tyro.cli(Options, config=(tyro.conf.OmitArgPrefixes,)))
