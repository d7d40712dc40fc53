"""Evaluation of a motion between its frames."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.rotations import Array


def sample_at(motion: Motion, times: Array, fps: float) -> Motion:
    """Sample a motion at given times.

    Positions and rotations both follow C2 cubic splines; rotations as quaternion components of
    one hemisphere, renormalised, which stays C2 and within 0.01 degree of slerp at 20 fps.

    Args:
        motion: At least one frame.
        times: Increasing times [N] within 0 to `motion.duration`, s.
        fps: The rate that the result states.

    Returns:
        A motion of N frames.
    """
    if motion.frames < 2:
        index = np.zeros(len(times), dtype=int)
        return Motion(motion.root[index], motion.rotations[index], fps, motion.skeleton)
    knots = np.arange(motion.frames) / motion.fps
    times = np.clip(times, 0.0, knots[-1])
    root = CubicSpline(knots, motion.root)(times)
    quaternions = CubicSpline(knots, rot.continuous(motion.rotations))(times)
    return Motion(root, rot.normalise(quaternions), fps, motion.skeleton)
