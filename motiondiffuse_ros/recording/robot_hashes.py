"""What tells one robot from another of its name."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path

import mujoco
import numpy as np

from motiondiffuse_ros.hashing import file_sha256
from motiondiffuse_ros.robots import Robot
from motiondiffuse_ros.robots.description_file import shipped_descriptions

DESCRIPTION, MODEL = "robot/description", "robot/model"


def robot_hashes(robot: Robot) -> dict[str, str]:
    """Return the SHA-256 of a robot's description, if that is a file, and of its compiled model.

    The model's hash covers meshes and included files, and changes with MuJoCo's version.
    """
    buffer = np.empty(mujoco.mj_sizeModel(robot.model), dtype=np.uint8)
    mujoco.mj_saveModel(robot.model, None, buffer)
    hashes = {MODEL: sha256(buffer.tobytes()).hexdigest()}
    file = shipped_descriptions().get(robot.name, Path(robot.name).expanduser())
    if file.is_file():
        hashes[DESCRIPTION] = file_sha256(file)
    return hashes
