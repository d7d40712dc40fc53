"""Motions as the parameters of SMPL, for tests."""

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.frames import quaternions_to_y_up, vectors_to_y_up


def smpl_poses(motion: Motion, world: np.ndarray, joints: int) -> tuple[np.ndarray, np.ndarray]:
    """Return rotation vectors [T, 3 * joints] and root positions [T, 3].

    Args:
        motion: The motion.
        world: Rotation [4] from our y-up frame into the world of the data.
        joints: SMPL's 24 or SMPL+H's 52; the hands do not move.
    """
    rotations = quaternions_to_y_up(motion.rotations)
    rotations[:, 0] = rot.multiply(world, rotations[:, 0])
    poses = np.zeros((motion.frames, joints, 3))
    poses[:, :22] = rot.to_rotation_vector(rotations)
    return poses.reshape(motion.frames, -1), rot.rotate(world, vectors_to_y_up(motion.root))
