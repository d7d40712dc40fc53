"""How well do motions become a robot's?

    python -m benchmarks.g1 --corpus DIR [--motions 100] [--robot g1] [--json F]

Clips of the test split at random, and as many motions sampled from their captions with few steps,
are made trajectories for the robot. Every figure is of the trajectories as they leave for a
controller: at 20 Hz for what the feet and the body do, at 50 Hz for the rest.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import mujoco
import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy.ndimage import uniform_filter1d

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES, TOE_HEIGHT
from motiondiffuse_ros.physics.foot_skating import (
    GMD_HEIGHT,
    GMD_SPEED,
    GMD_WINDOW,
    foot_skating,
)
from motiondiffuse_ros.physics.humanoid import humanoid_model
from motiondiffuse_ros.physics.repair import put_on_floor
from motiondiffuse_ros.physics.state import motion_to_qpos
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.robots import Robot, broken_promises, build_trajectory, get_robot
from motiondiffuse_ros.robots.embodiment import embodiment
from motiondiffuse_ros.robots.trajectory import JointTrajectory
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState

RATE = 20.0
"""Of the figures on feet and body [Hz]: what GMD's skating ratio supposes."""

DEEP = 0.01
"""Solids that overlap by more than this [m] penetrate each other."""


@dataclass(frozen=True)
class Options:
    """What to run."""

    corpus: Path
    """Corpus folder."""
    motions: int = 100
    """Clips, and as many sampled motions."""
    robot: str = "g1"
    """Name or description file."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    steps: int = 8
    """Denoising steps of the sampled motions."""
    seed: int = 0
    """Of the choice of clips and of the sampled motions."""
    json: Path | None = None
    """Where to write the figures."""


@dataclass(frozen=True)
class Figures:
    """Of one set of motions.

    Attributes:
        motions: How many.
        seconds: How long in all.
        broken: Trajectories that the validator finds fault with: limits of position and speed,
            times, rest at the end, velocities that belong to the positions.
        slowed: Trajectories that had to be slowed down to keep the limits of speed.
        skating: Skating ratio of the robot (GMD's, heights and speeds scaled by the legs).
        source_skating: Skating ratio of the motions.
        penetrations: Motions in which the robot penetrates itself in a frame in which the skeleton
            does not.
        deepest_mm: Largest self-penetration of the robot.
        below_floor_mm: Largest depth of a sole below the floor.
        realtime_factor: Seconds of motion that one second of work makes a trajectory of.
        cpu_factor: The same by the time of the processor, whoever else uses it.
    """

    motions: int
    seconds: float
    broken: int
    slowed: int
    skating: float
    source_skating: float
    penetrations: int
    deepest_mm: float
    below_floor_mm: float
    realtime_factor: float
    cpu_factor: float


def main() -> None:
    """Measure and print."""
    options = tyro.cli(Options)
    robot = get_robot(options.robot)
    embodiment(robot)
    sets = {"real": list(real_motions(options)), "sampled": list(sampled_motions(options))}
    figures = {name: measure(robot, motions, name) for name, motions in sets.items()}
    _print(figures, robot)
    if options.json:
        settings = {"motions": options.motions, "steps": options.steps, "seed": options.seed}
        record = {"robot": robot.name, **settings, **{k: asdict(v) for k, v in figures.items()}}
        options.json.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")


def real_motions(options: Options) -> Iterator[Motion]:
    """Yield clips of the test split."""
    corpus = Corpus.load(options.corpus)
    for clip in _drawn(corpus, options):
        yield corpus.representation.decode(corpus.of(clip), corpus.fps)


def sampled_motions(options: Options) -> Iterator[Motion]:
    """Yield motions sampled from the captions of the clips, of at most 5 s."""
    corpus = Corpus.load(options.corpus)
    pipeline = MotionPipeline.from_pretrained(options.weights or shipped_weights(), None)
    clips = _drawn(corpus, options)
    for n, clip in enumerate(track(clips, "sampling")):
        frames = min(clip.frames, round(5.0 * pipeline.fps) + 1)
        text = TimedText(clip.captions[0], 0, frames, ())
        config = SamplerConfig(steps=options.steps)
        samples = pipeline(
            (text,), frames, config=config, candidates=1, seed=options.seed + n, blend_frames=0
        )
        yield put_on_floor(samples.motions[0])


def _drawn(corpus: Corpus, options: Options) -> list:
    clips = corpus.split("test")
    drawn = np.random.default_rng(options.seed).permutation(len(clips))[: options.motions]
    return [clips[n] for n in drawn]


def measure(robot: Robot, motions: list[Motion], name: str) -> Figures:
    """Make trajectories of motions and judge them."""
    tallies = [judge(robot, motion) for motion in track(motions, name)]

    def total(key: str) -> float:
        return float(sum(tally[key] for tally in tallies))

    return Figures(
        motions=len(motions),
        seconds=total("seconds"),
        broken=int(total("broken")),
        slowed=int(total("slowed")),
        skating=total("skates") / total("frames"),
        source_skating=total("source_skates") / total("source_frames"),
        penetrations=int(total("penetrates")),
        deepest_mm=1e3 * max(tally["deepest"] for tally in tallies),
        below_floor_mm=1e3 * max(tally["below"] for tally in tallies),
        realtime_factor=total("seconds") / total("wall"),
        cpu_factor=total("seconds") / total("cpu"),
    )


def judge(robot: Robot, motion: Motion) -> dict[str, float]:
    """Return what counts of one motion."""
    wall, cpu = time.perf_counter(), time.process_time()
    trajectory = build_trajectory(robot, motion)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    qpos = states(trajectory)
    soles = sole_corners(robot, qpos)
    skates = skating(soles, embodiment(robot).scale)
    depth = self_penetration(robot.model, qpos)
    source = foot_skating(motion.resample(RATE))
    source_depth = self_penetration(humanoid_model(), motion_to_qpos(motion.resample(RATE)))
    both = min(len(depth), len(source_depth))
    lacks = (depth[:both] > DEEP) & (source_depth[:both] <= DEEP)
    return {
        "seconds": motion.duration,
        "wall": wall,
        "cpu": cpu,
        "broken": len(broken_promises(trajectory, robot)) > 0,
        "slowed": any("slowed" in note for note in trajectory.notes),
        "skates": float(skates.sum()),
        "frames": len(skates),
        "source_skates": float(source.skating.any(axis=1).sum()),
        "source_frames": len(source.skating),
        "penetrates": bool(lacks.any()),
        "deepest": float(depth.max()),
        "below": float(max(-soles[..., 2].min(), 0.0)),
    }


def states(trajectory: JointTrajectory) -> Array:
    """Return a trajectory's `qpos` [T, 7 + J] at `RATE`."""
    between = TrajectoryState(trajectory)
    rows = []
    for n in range(int(trajectory.duration * RATE) + 1):
        state = between.at(n / RATE)
        assert state.root is not None
        rows.append(np.concatenate([state.root.position, state.root.orientation, state.positions]))
    return np.array(rows)


def sole_corners(robot: Robot, qpos: Array) -> Array:
    """Return the corners of both soles, rear ones first [T, 2, 4, 3], m."""
    data, body = mujoco.MjData(robot.model), embodiment(robot)
    corners = np.empty((len(qpos), 2, 4, 3))
    for frame, state in enumerate(qpos):
        data.qpos[:] = state
        mujoco.mj_kinematics(robot.model, data)
        for n, side in enumerate(SIDES):
            ankle = data.site(robot.description.body_map[f"{side}_ankle"])
            turned = body.soles[side] @ ankle.xmat.reshape(3, 3).T
            corners[frame, n] = ankle.xpos + turned
    return corners


def skating(corners: Array, scale: float) -> Array:
    """Return whether a foot skates from each frame to the next [T - 1].

    The toe edge stands for the ball of the foot, whose joint is `TOE_HEIGHT` above the floor.
    """
    toes = corners[:, :, 2:].mean(axis=2)
    high = scale * (GMD_HEIGHT - TOE_HEIGHT)
    low = (toes[1:, :, 2] < high) & (toes[:-1, :, 2] < high)
    speed = np.linalg.norm(np.diff(toes[..., :2], axis=0), axis=-1) * RATE
    smooth = uniform_filter1d(speed, GMD_WINDOW, axis=0, mode="constant") if len(speed) else speed
    fast = scale * GMD_SPEED
    return (low & (speed > fast) & (smooth > fast)).any(axis=1)


def self_penetration(model: mujoco.MjModel, qpos: Array) -> Array:
    """Return the deepest overlap of two solids of a body in each frame [T], m."""
    data, depths = mujoco.MjData(model), np.zeros(len(qpos))
    for frame, state in enumerate(qpos):
        data.qpos[:] = state
        data.qpos[3:7] = rot.normalise(data.qpos[3:7])
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        own = (model.geom_bodyid[data.contact.geom] > 0).all(axis=1)
        depths[frame] = -np.min(data.contact.dist, initial=0.0, where=own)
    return depths


def _print(figures: dict[str, Figures], robot: Robot) -> None:
    table = Table(title=f"Motions made trajectories of {robot.name}")
    table.add_column("")
    for name in figures:
        table.add_column(name, justify="right")
    rows = {name: asdict(values) for name, values in figures.items()}
    for key in next(iter(rows.values())):
        table.add_row(key, *(f"{row[key]:.4g}" for row in rows.values()))
    Console().print(table)


if __name__ == "__main__":
    main()
