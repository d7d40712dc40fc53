"""Rotations as three hinges and back, in any order of axes, continuous over time."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array

AXES = "xyz"


def hinge_angles(rotations: Array, order: str) -> Array:
    """Split rotations into principal angles about three body axes.

    Args:
        rotations: [..., 4], wxyz.
        order: The axes from the parent's side to the child's, such as "yxz": the rotation is
            R_y(a) R_x(b) R_z(c).

    Returns:
        Angles a, b, c [..., 3], rad; b within +-pi/2, the others within +-pi.
    """
    i, j, k = (AXES.index(axis) for axis in order)
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    m = rot.to_matrix(rotations)
    cosine = np.hypot(m[..., i, i], m[..., i, j])
    middle = np.arctan2(sign * m[..., i, k], cosine)
    # with the middle at 90 degrees only one of the two others is free: the last is zero then
    free = cosine > 1e-7
    first = np.where(
        free,
        np.arctan2(-sign * m[..., j, k], m[..., k, k]),
        np.arctan2(sign * m[..., k, j], m[..., j, j]),
    )
    last = np.where(free, np.arctan2(-sign * m[..., i, j], m[..., i, i]), 0.0)
    return np.stack([first, middle, last], axis=-1)


def continuous_hinge_angles(rotations: Array, order: str, centre: Array) -> Array:
    """Split rotations over time so that no angle jumps.

    Every rotation has two triples of angles, (a, b, c) and (a + pi, pi - b, c + pi), each modulo
    2 pi. Along time the nearer triple is taken. Which of the two paths it is, and its whole
    turns, is chosen for the clip: the one that stays nearer to the middle of the hinges' ranges.

    Args:
        rotations: Of one joint or more, [T, ..., 4], wxyz.
        order: As for `hinge_angles`.
        centre: Middle of the range of each hinge [..., 3], rad.

    Returns:
        Angles [T, ..., 3], rad.
    """
    principal = hinge_angles(rotations, order)
    other = _other_triple(principal)
    stays = _distance(principal[1:], principal[:-1])
    # the second triple of one rotation is as far from the first of another as vice versa
    switches = _distance(principal[1:], other[:-1]) < stays
    branch = np.zeros(principal.shape[:-1], dtype=bool)
    np.logical_xor.accumulate(switches, axis=0, out=branch[1:])
    one, two = (
        _nearest_turns(np.unwrap(np.where(flag[..., None], other, principal), axis=0), centre)
        for flag in (branch, ~branch)
    )
    off_one, off_two = (np.abs(path - centre).mean(axis=(0, -1)) for path in (one, two))
    return np.where((off_one <= off_two)[..., None], one, two)


def hinge_rotations(angles: Array, order: str) -> Array:
    """Chain three hinges into rotations: the inverse of `hinge_angles`.

    Args:
        angles: [..., 3], rad.
        order: As for `hinge_angles`.

    Returns:
        Rotations [..., 4], wxyz.
    """
    first, middle, last = (
        rot.about_axis(AXES.index(axis), angles[..., n]) for n, axis in enumerate(order)
    )
    return rot.multiply(rot.multiply(first, middle), last)


def _other_triple(angles: Array) -> Array:
    return np.stack([angles[..., 0] + np.pi, np.pi - angles[..., 1], angles[..., 2] + np.pi], -1)


def _distance(a: Array, b: Array) -> Array:
    difference = (a - b + np.pi) % (2 * np.pi) - np.pi
    return np.sum(difference**2, axis=-1)


def _nearest_turns(path: Array, centre: Array) -> Array:
    turns = np.round((path.mean(axis=0) - centre) / (2 * np.pi))
    return path - 2 * np.pi * turns
