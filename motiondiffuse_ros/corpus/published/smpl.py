"""Poses of the SMPL body model, and the frames they are published in.

SMPL's joints are ours and, without its two hands, in our order. Its pose is local rotations of a
body that stands in a T-pose, y up and z ahead, as ours do; carried over as they are they leave
out that its legs stand slightly apart then.
"""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.frames import quaternions_to_z_up, vectors_to_z_up
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL

JOINTS = len(CANONICAL.names)

FROM_CAMERA = rot.about_axis(0, np.array(np.pi))
"""From x right, y down, z away to x right, y up, z near."""

FROM_Z_UP = rot.from_matrix(np.eye(3)[[1, 2, 0]])
"""From z up to y up by turning the axes on."""


def camera_to_z_up(points: Array) -> Array:
    """Turn points [..., 3] of a camera's frame (y down) into our world."""
    return vectors_to_z_up(rot.rotate(FROM_CAMERA, points))


UPSIDE_DOWN = "head below the feet (as published, y points down)"
"""Why a clip of a camera's frame is dropped whose axes are others than those published."""


def upside_down(motion: Motion) -> bool:
    """Return whether the head is below the feet most of the time."""
    feet = 0.5 * (motion.joint("left_foot") + motion.joint("right_foot"))
    return bool(np.median((motion.joint("head") - feet)[:, 2]) < 0.0)


def motion_from_smpl(pose: Array, path: Array, world: Array, fps: float) -> Motion:
    """Return the motion of SMPL's pose parameters.

    Args:
        pose: Rotation vectors [T, at least 66] in the order of the joints, the root's first.
        path: Root positions [T, 3], m.
        world: The rotation [4] from the data's world into one with y up.
        fps: Their rate, Hz.
    """
    rotations = rot.from_rotation_vector(pose[:, : 3 * JOINTS].reshape(-1, JOINTS, 3).astype(float))
    rotations[:, 0] = rot.multiply(world, rotations[:, 0])
    root = vectors_to_z_up(rot.rotate(world, path.astype(float)))
    return Motion(root, rot.normalise(quaternions_to_z_up(rotations)), fps)
