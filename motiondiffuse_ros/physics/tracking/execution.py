"""What a body did that followed a motion on its own feet."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion.bvh import write_bvh
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.hinge_table import hinge_table


@dataclass(frozen=True, eq=False)
class Execution:
    """A motion as it was executed in simulation, up to its end or the fall; N samples.

    Attributes:
        motion: What the body did, at the rate of the motion that it followed.
        success: Whether it never was `FALL_DISTANCE` from the reference in the mean.
        diverged: Whether the simulation broke down.
        time_to_fall: First time at which the body has fallen, or the motion's duration, s.
        mpjpe: Mean distance of the joints from the reference, in the world, mm.
        mpjpe_local: The same with both roots in one place, mm.
        largest_error: Largest mean distance over the joints of any sample, mm.
        rate: Samples a second [Hz].
        qpos: States [N, 70].
        torques: Of the hinges [N, 63], N m.
        contact_forces: Of the floor on every joint's body, in the world [N, 22, 3], N.
        seconds: Time it took to compute, s.
    """

    motion: Motion = field(repr=False)
    success: bool
    diverged: bool
    time_to_fall: float
    mpjpe: float
    mpjpe_local: float
    largest_error: float
    rate: float
    qpos: Array = field(repr=False)
    torques: Array = field(repr=False)
    contact_forces: Array = field(repr=False)
    seconds: float

    def metrics(self) -> dict[str, float | None]:
        """Return what a physics report says about it."""
        return {
            "execution_success": float(self.success),
            "execution_time_to_fall_s": self.time_to_fall,
            "execution_mpjpe_mm": self.mpjpe,
        }

    def to_dict(self) -> dict[str, Any]:
        """Return the figures, for JSON."""
        return {
            "success": self.success,
            "diverged": self.diverged,
            "time_to_fall_s": self.time_to_fall,
            "mpjpe_mm": self.mpjpe,
            "mpjpe_local_mm": self.mpjpe_local,
            "largest_error_mm": self.largest_error,
            "peak_torque_nm": float(np.abs(self.torques).max()),
            "seconds": self.seconds,
        }

    def save(self, folder: Path) -> None:
        """Write executed.npz and executed.bvh (the motion), forces.npz and execution.json.

        forces.npz holds `rate` [Hz], `joint_names`, `hinge_names`, `qpos` [N, 70], `torques`
        [N, 63] N m and `contact_forces` [N, 22, 3] N.
        """
        folder.mkdir(parents=True, exist_ok=True)
        self.motion.save_npz(folder / "executed.npz")
        write_bvh(self.motion, folder / "executed.bvh")
        np.savez_compressed(
            folder / "forces.npz",
            rate=self.rate,
            joint_names=np.array(CANONICAL.names),
            hinge_names=np.array(hinge_table().names),
            qpos=self.qpos,
            torques=self.torques,
            contact_forces=self.contact_forces,
        )
        figures = json.dumps(self.to_dict(), indent=2)
        (folder / "execution.json").write_text(figures + "\n", encoding="utf-8")
