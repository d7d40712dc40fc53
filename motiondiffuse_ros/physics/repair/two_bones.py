"""Analytic inverse kinematics of a leg: hip and knee that bring the ankle to a place."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array

_NEARLY_STRAIGHT = 0.9995
"""A leg is never stretched beyond this share of its length: knees lock there."""

_CLEARLY_BENT = 0.14  # sine of the knee's angle from which its plane is taken from the motion


def reach_ankle(
    hip: Array, knee: Array, ankle: Array, target: Array, thigh: Array, shank: Array, side: Array
) -> tuple[Array, Array]:
    """Turn a leg so that its ankle is at a target, its knee bending in the plane it bends in.

    Args:
        hip: Position over time [T, 3], m; stays.
        knee: Position [T, 3], m.
        ankle: Position [T, 3], m.
        target: Of the ankle [T, 3], m; one out of reach is approached along the line to it.
        thigh: World rotation of the thigh [T, 4].
        shank: World rotation of the shank [T, 4].
        side: World direction about which a straight knee would bend [T, 3].

    Returns:
        World rotations of thigh and shank [T, 4].
    """
    upper = np.linalg.norm(knee - hip, axis=-1)
    lower = np.linalg.norm(ankle - knee, axis=-1)
    longest = _NEARLY_STRAIGHT * (upper + lower)
    now = np.linalg.norm(ankle - hip, axis=-1)
    # a leg that is straight in the motion may stay so
    shortest, longest = np.abs(upper - lower) + 1e-3, np.maximum(now, longest)
    wanted = np.clip(np.linalg.norm(target - hip, axis=-1), shortest, longest)
    plane = np.cross(knee - hip, ankle - knee)
    bent = np.linalg.norm(plane, axis=-1) / (upper * lower)
    axis = np.where((bent > _CLEARLY_BENT)[:, None], rot.unit(plane), side)
    at_hip = _corner(upper, wanted, lower) - _corner(upper, now, lower)
    at_knee = _corner(upper, lower, wanted) - _corner(upper, lower, now)
    # the thigh turns away from the line to the ankle as the knee closes
    bend_thigh = rot.from_rotation_vector(-axis * at_hip[:, None])
    bend_shank = rot.from_rotation_vector(-axis * (at_hip + at_knee)[:, None])
    reached = rot.rotate(bend_thigh, knee - hip) + rot.rotate(bend_shank, ankle - knee)
    swing = rot.shortest_arc(reached, target - hip)
    return (
        rot.multiply(swing, rot.multiply(bend_thigh, thigh)),
        rot.multiply(swing, rot.multiply(bend_shank, shank)),
    )


def _corner(a: Array, b: Array, opposite: Array) -> Array:
    """Return the angle between sides a and b of a triangle [rad]."""
    return np.arccos(np.clip((a**2 + b**2 - opposite**2) / (2 * a * b), -1.0, 1.0))
