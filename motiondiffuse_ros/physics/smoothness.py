"""Jerk of the joints: FlowMDM (Barquero et al., CVPR 2024) reports its peak and its area."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array


def joint_jerk(motion: Motion) -> Array:
    """Return the jerk of every joint [T - 3, 22], m/s^3; see `jerk_of`."""
    return jerk_of(motion.positions, motion.fps)


def jerk_of(places: Array, fps: float) -> Array:
    """Return the jerk of points [T, J, 3] in the world as its norm [T - 3, J], m/s^3.

    Third differences times the cube of the rate; it grows with the rate where a motion is noisy,
    hence the report takes it at 20 fps.
    """
    return np.linalg.norm(np.diff(places, n=3, axis=0) * fps**3, axis=-1)
