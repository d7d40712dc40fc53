"""What a simulated robot did, and its file."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion.rotations import Array


@dataclass(frozen=True, eq=False)
class ExecutedMotion:
    """What a robot did while it followed a trajectory, sampled uniformly; T samples.

    Attributes:
        robot: Name of the robot.
        fps: Samples a second [Hz].
        assisted: Whether an outside force held the root on its path.
        qpos: State [T, 7 + J] in MuJoCo's order.
        reference: State asked for [T, 7 + J].
        assistance: Size of the outside force [T], in body weights.
    """

    robot: str
    fps: float
    assisted: bool
    qpos: Array = field(repr=False)
    reference: Array = field(repr=False)
    assistance: Array = field(repr=False)

    @property
    def joint_error(self) -> float:
        """Root mean square of the joints' errors [rad]."""
        return float(np.sqrt(np.mean((self.qpos[:, 7:] - self.reference[:, 7:]) ** 2)))

    @property
    def root_error(self) -> float:
        """Mean distance of the root from its reference [m]."""
        return float(np.linalg.norm(self.qpos[:, :3] - self.reference[:, :3], axis=1).mean())

    def save_npz(self, path: Path) -> None:
        """Write all fields; the file appears complete or not at all."""
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(f".{path.name}.part")
        with part.open("wb") as file:
            np.savez_compressed(file, **vars(self))
        os.replace(part, path)

    @classmethod
    def load_npz(cls, path: Path) -> ExecutedMotion:
        """Read what `save_npz` wrote.

        Raises:
            MotionFileError: If the file is not such an archive.
        """
        try:
            with np.load(path, allow_pickle=False) as data:
                return cls(
                    robot=str(data["robot"]),
                    fps=float(data["fps"]),
                    assisted=bool(data["assisted"]),
                    qpos=data["qpos"],
                    reference=data["reference"],
                    assistance=data["assistance"],
                )
        except (OSError, ValueError, KeyError) as error:
            raise MotionFileError(f"{path}: not an executed motion ({error})") from error
