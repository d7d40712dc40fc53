"""How real clips fit the humanoid's hinges: orders of axes, ranges and speeds.

    python benchmarks/humanoid_hinges.py --cmu DIR --bandai-namco DIR

First table: for each joint and each order of axes the angle of the middle hinge that 99.9 % of
the frames stay under (at 90 degrees the hinges lock), and the order in use. Second: the share of
frames beyond the ranges and speeds of `physics/hinge_table.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from rich.table import Table

from motiondiffuse_ros.corpus import load_motion
from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.hinges import hinge_angles
from motiondiffuse_ros.physics.joint_limits import LimitExcess, limit_excess
from motiondiffuse_ros.physics.state import hinges_from_motion

ORDERS = ["".join(order) for order in permutations("xyz")]
MIRROR = np.array([1.0, -1.0, 1.0, -1.0])


@dataclass
class Arguments:
    """Where the clips are and how many to take."""

    cmu: Path
    """Folder of the CMU BVH files."""
    bandai_namco: Path
    """Folder of the Bandai-Namco BVH files."""
    clips: int = 200
    """Clips of each set."""
    seed: int = 1
    """Of the choice."""


def load(folder: Path, count: int, rng: np.random.Generator) -> list[Motion]:
    """Return up to `count` motions at 20 fps."""
    paths = sorted(folder.glob("*.bvh"))
    motions = []
    for index in track(rng.permutation(len(paths))[:count], description=folder.name):
        try:
            motions.append(load_motion(paths[index]).resample(20.0))
        except MotionFileError as error:
            Console(stderr=True).print(f"left out: {error}")
    return motions


def order_table(motions: list[Motion]) -> Table:
    """Return the middle hinge's angle by joint and order, both sides of the body together."""
    table = hinge_table()
    out = Table("joint", *ORDERS, "in use", "zero tilted by")
    for n, (joint, used) in enumerate(zip(table.joints, table.orders, strict=True)):
        name = CANONICAL.names[joint]
        if name.startswith("right_"):
            continue
        other = CANONICAL.mirror_index[joint]
        both = [m.rotations[:, joint] for m in motions]
        if other != joint:
            both += [m.rotations[:, other] * MIRROR for m in motions]
        turned = rot.multiply(np.concatenate(both), rot.about_axis(0, -table.tilts[n]))
        middles = {order: np.abs(hinge_angles(turned, order)[:, 1]) for order in ORDERS}
        cells = [f"{np.degrees(np.quantile(middles[order], 0.999)):.0f}" for order in ORDERS]
        tilt = np.degrees(table.tilts[n])
        out.add_row(name, *cells, used, f"{tilt:.0f}" if tilt else "")
    return out


def excess_of(motion: Motion) -> LimitExcess:
    """Compare a motion with the humanoid's limits."""
    table = hinge_table()
    joints = hinges_from_motion(motion)
    return limit_excess(joints, motion.fps, table.lower, table.upper, table.velocity_limits)


def main(arguments: Arguments) -> None:
    """Print both tables."""
    rng = np.random.default_rng(arguments.seed)
    sets = {
        "cmu": load(arguments.cmu, arguments.clips, rng),
        "bandai-namco": load(arguments.bandai_namco, arguments.clips, rng),
    }
    console = Console()
    console.print(order_table([motion for motions in sets.values() for motion in motions]))
    fit = Table("", "clips", "frames beyond a range", "clips never beyond", "frames too fast")
    for name, motions in sets.items():
        excess = [excess_of(motion) for motion in motions]
        weights = np.array([motion.frames for motion in motions])
        beyond = np.array([e.position_violation for e in excess])
        fast = np.array([e.speed_violation for e in excess])
        fit.add_row(
            name,
            str(len(motions)),
            f"{np.average(beyond, weights=weights):.1%}",
            f"{np.mean(beyond == 0.0):.0%}",
            f"{np.average(fast, weights=weights):.2%}",
        )
    console.print(fit)


if __name__ == "__main__":
    main(tyro.cli(Arguments))
