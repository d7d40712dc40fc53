"""Which feet carry the body: contact labels from the kinematics alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.skeleton import ANKLE_HEIGHT, TOE_HEIGHT

CONTACT_JOINTS = ("left_ankle", "left_foot", "right_ankle", "right_foot")

HEIGHT_TOLERANCE = 0.05
"""A joint this far [m] above its height in a flat stance may still touch the floor."""

SPEED_TOLERANCE = 0.5
"""A joint slower than this [m/s] may be in contact."""


def detect_contacts(motion: Motion) -> NDArray[np.bool_]:
    """Label heels and toes in contact with the floor at z = 0.

    Returns:
        Labels [T, 4] in the order of `CONTACT_JOINTS`.
    """
    joints = [motion.skeleton.index(name) for name in CONTACT_JOINTS]
    positions = motion.positions[:, joints]
    speed = np.zeros(positions.shape[:2])
    if motion.frames > 1:
        step = np.linalg.norm(np.diff(positions, axis=0), axis=-1) * motion.fps
        speed = np.concatenate([step, step[-1:]])
    flat = np.array([ANKLE_HEIGHT, TOE_HEIGHT, ANKLE_HEIGHT, TOE_HEIGHT])
    return (positions[..., 2] < flat + HEIGHT_TOLERANCE) & (speed < SPEED_TOLERANCE)
