"""Jerk of the joints: FlowMDM (Barquero et al., CVPR 2024) reports its peak and its area."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array


def joint_jerk(motion: Motion) -> Array:
    """Return the jerk of every joint [T - 3, 22], m/s^3.

    Third differences of the world joint positions times the cube of the rate; it grows with the
    rate where a motion is noisy, hence the report takes it at 20 fps.
    """
    jerk = np.diff(motion.positions, n=3, axis=0) * motion.fps**3
    return np.linalg.norm(jerk, axis=-1)
