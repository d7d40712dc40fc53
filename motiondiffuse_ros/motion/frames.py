"""The two frames of this package and the change between them.

Outside `motion/` everything is z up, x forward, y left (REP-103). BVH files and the pose state
of Guo et al. 2022 are y up, z forward, x left. The change is a cyclic permutation of the axes,
hence a proper rotation: it acts on a quaternion by permuting its vector part.
"""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion.rotations import Array

_TO_Y_UP = np.array([1, 2, 0])
_TO_Z_UP = np.array([2, 0, 1])


def vectors_to_y_up(v: Array) -> Array:
    """Permute [..., 3] from (x forward, y left, z up) to (x left, y up, z forward)."""
    return v[..., _TO_Y_UP]


def vectors_to_z_up(v: Array) -> Array:
    """Permute [..., 3] from (x left, y up, z forward) to (x forward, y left, z up)."""
    return v[..., _TO_Z_UP]


def quaternions_to_y_up(q: Array) -> Array:
    """Express rotations [..., 4] (wxyz) in the y-up frame."""
    return np.concatenate([q[..., :1], vectors_to_y_up(q[..., 1:])], axis=-1)


def quaternions_to_z_up(q: Array) -> Array:
    """Express rotations [..., 4] (wxyz) in the z-up frame."""
    return np.concatenate([q[..., :1], vectors_to_z_up(q[..., 1:])], axis=-1)
