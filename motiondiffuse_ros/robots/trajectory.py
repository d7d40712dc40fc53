"""`JointTrajectory`: what leaves for a controller, and its files."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array


@dataclass(frozen=True, eq=False)
class Source:
    """What a trajectory was made from.

    Attributes:
        motion: Of the skeleton.
        times: Time in the motion at each point [N], s; its first frame before the motion begins.
    """

    motion: Motion = field(repr=False)
    times: Array = field(repr=False)


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """N timed points of J joints and the floating base. `broken_promises` checks all of it.

    Attributes:
        joint_names: [J].
        times: From the start [N], s; strictly increasing from 0.
        positions: [N, J], rad; inside the robot's limits.
        velocities: [N, J], rad/s; central differences of the positions, the last exactly zero.
        root_position: Floating base in the world [N, 3], m.
        root_orientation: Floating base in the world [N, 4], wxyz.
        root_linear_velocity: In the world frame [N, 3], m/s; the last exactly zero.
        root_angular_velocity: In the world frame [N, 3], rad/s; the last exactly zero.
        notes: What had to be changed to keep limits, in words.
        accelerations: [N, J], rad/s^2, central differences of the velocities; None where nobody
            asked for them.
        source: What it was made from; None where that is not known.
    """

    joint_names: tuple[str, ...] = field(repr=False)
    times: Array = field(repr=False)
    positions: Array = field(repr=False)
    velocities: Array = field(repr=False)
    root_position: Array = field(repr=False)
    root_orientation: Array = field(repr=False)
    root_linear_velocity: Array = field(repr=False)
    root_angular_velocity: Array = field(repr=False)
    notes: tuple[str, ...] = ()
    accelerations: Array | None = field(default=None, repr=False)
    source: Source | None = field(default=None, repr=False)

    @property
    def duration(self) -> float:
        """Time of the last point [s]."""
        return float(self.times[-1])

    def save_csv(self, path: Path) -> None:
        """Write `time` and, for each joint, `NAME_position` and `NAME_velocity`."""
        columns = np.stack([self.positions, self.velocities], axis=2).reshape(len(self.times), -1)
        header = [
            f"{name}_{kind}" for name in self.joint_names for kind in ("position", "velocity")
        ]
        _write(path, ["time", *header], np.column_stack([self.times, columns]))

    def save_root_csv(self, path: Path) -> None:
        """Write the floating base: `time,x,y,z,qw,qx,qy,qz`."""
        header = ["time", "x", "y", "z", "qw", "qx", "qy", "qz"]
        rows = np.column_stack([self.times, self.root_position, self.root_orientation])
        _write(path, header, rows)


def _write(path: Path, header: list[str], rows: Array) -> None:
    np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=",".join(header), comments="")
