"""Between `Motion` and the humanoid's generalised positions, exactly, both ways."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.hinges import continuous_hinge_angles, hinge_rotations


def hinges_from_motion(motion: Motion) -> Array:
    """Return the humanoid's hinge angles [T, 63], rad, continuous and not clamped."""
    table = hinge_table()
    middle = ((table.lower + table.upper) / 2).reshape(-1, 3)
    turned = rot.multiply(motion.rotations[:, list(table.joints)], rot.about_axis(0, -table.tilts))
    out = np.empty((motion.frames, len(table.joints), 3))
    for order in set(table.orders):
        same = [n for n, other in enumerate(table.orders) if other == order]
        out[:, same] = continuous_hinge_angles(turned[:, same], order, middle[same])
    return out.reshape(motion.frames, -1)


def motion_to_qpos(motion: Motion) -> Array:
    """Return the humanoid's `qpos` [T, 70]: root position, root quaternion wxyz, hinges."""
    root = rot.continuous(motion.rotations[:, 0])
    return np.concatenate([motion.root, root, hinges_from_motion(motion)], axis=1)


def qpos_to_motion(qpos: Array, fps: float) -> Motion:
    """Undo `motion_to_qpos`.

    Args:
        qpos: [T, 70].
        fps: Frames per second.
    """
    table = hinge_table()
    rotations = rot.identity(len(qpos), len(table.joints) + 1)
    rotations[:, 0] = rot.normalise(qpos[:, 3:7])
    for n, (joint, order) in enumerate(zip(table.joints, table.orders, strict=True)):
        turned = hinge_rotations(qpos[:, 7 + 3 * n : 10 + 3 * n], order)
        rotations[:, joint] = rot.multiply(turned, rot.about_axis(0, table.tilts[n]))
    return Motion(qpos[:, :3].copy(), rotations, fps)


def state_velocities(qpos: Array, fps: float) -> tuple[Array, Array]:
    """Differentiate `qpos` centrally, in MuJoCo's conventions.

    Args:
        qpos: [T, 7 + K], T at least 3; quaternions of one hemisphere.
        fps: Frames per second.

    Returns:
        `qvel` and `qacc` [T - 2, 6 + K] of the inner frames: linear parts in the world, angular
        parts of the root in its own frame.
    """
    spin = rot.to_rotation_vector(rot.multiply(qpos[1:, 3:7], rot.conjugate(qpos[:-1, 3:7]))) * fps
    linear, hinges = np.diff(qpos[:, :3], axis=0) * fps, np.diff(qpos[:, 7:], axis=0) * fps
    halves = np.concatenate([linear, spin, hinges], axis=1)
    velocity, acceleration = (halves[1:] + halves[:-1]) / 2, (halves[1:] - halves[:-1]) * fps
    back = rot.conjugate(qpos[1:-1, 3:7])
    for part in (velocity, acceleration):
        part[:, 3:6] = rot.rotate(back, part[:, 3:6])
    return velocity, acceleration
