"""A motion of the canonical skeleton from joint positions alone.

Positions do not hold everything: the twist of a bone about its own axis cannot be seen, nor the
rotation of hands, head and toes, after which no joint follows. Pelvis and chest take their frame
from hips and spine, collars and neck; every other bone turns by the shortest arc from where its
parent leaves it, which adds no twist.
"""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL, LEG_LENGTH

_REST = CANONICAL.positions(np.zeros(3), rot.identity(len(CANONICAL.names)))
_HIPS = (CANONICAL.index("left_hip"), CANONICAL.index("right_hip"))
_CHEST = CANONICAL.index("spine3")
_COLLARS = (CANONICAL.index("left_collar"), CANONICAL.index("right_collar"))
_SPINE = {CANONICAL.index("spine1"): 1 / 3, CANONICAL.index("spine2"): 2 / 3}
_LEG = ("hip", "knee", "ankle")
_CHILD = {p: j for j, p in enumerate(CANONICAL.parents) if p >= 0}
"""A joint after each joint; the only one, but for pelvis and chest."""


def motion_from_positions(positions: Array, fps: float) -> Motion:
    """Return the canonical motion whose bones point as those of a body of any size.

    Args:
        positions: Of the canonical joints [T, 22, 3], z up, floor at z = 0, any unit.
        fps: Their rate, Hz.

    Returns:
        The motion; its path is that of the middle of the hips, scaled by leg length.

    Raises:
        ValueError: If hips or chest of a frame are a point or a line, which has no direction.
    """
    world = _orient(positions)
    middle = positions[:, _HIPS].mean(axis=1) * (LEG_LENGTH / leg_length(positions))
    root = root_under_hips(middle, world[:, 0])
    return Motion(root, CANONICAL.local_rotations(world), fps)


def root_under_hips(middle: Array, pelvis: Array) -> Array:
    """Return root positions [T, 3] from the middle of the hips [T, 3] and the pelvis' rotation."""
    return middle - rot.rotate(pelvis, CANONICAL.offsets[list(_HIPS)].mean(axis=0))


def leg_length(positions: Array) -> float:
    """Return the length from hip over knee to ankle, mean of both, median over frames."""
    chain = [[CANONICAL.index(f"{s}_{j}") for s in ("left", "right")] for j in _LEG]
    bones = np.linalg.norm(np.diff(positions[:, chain], axis=1), axis=-1)
    return max(float(np.median(bones.sum(axis=1).mean(axis=-1))), 1e-8)


def _orient(positions: Array) -> Array:
    """Return world rotations [T, 22, 4]."""
    world = np.empty((*positions.shape[:2], 4))
    spine1, neck = CANONICAL.index("spine1"), CANONICAL.index("neck")
    world[:, 0] = _turn(positions, _HIPS, None, spine1)
    chest = _turn(positions, _COLLARS, _CHEST, neck)
    for j, parent in enumerate(CANONICAL.parents):
        if j == 0:
            continue
        if j == _CHEST:
            world[:, j] = chest
            continue
        guess = rot.slerp(world[:, 0], chest, _SPINE[j]) if j in _SPINE else world[:, parent]
        child = _CHILD.get(j)
        if child is not None:
            bone = positions[:, child] - positions[:, j]
            arc = rot.shortest_arc(rot.rotate(guess, CANONICAL.offsets[child]), bone)
            guess = rot.multiply(arc, guess)
        world[:, j] = guess
    return world


def _turn(positions: Array, sides: tuple[int, int], base: int | None, top: int) -> Array:
    """Return how the frame of two sides and an upward line is turned from the T-pose."""
    now, rest = _frame(positions, sides, base, top), _frame(_REST, sides, base, top)
    return rot.multiply(now, rot.conjugate(rest))


def _frame(positions: Array, sides: tuple[int, int], base: int | None, top: int) -> Array:
    left, right = positions[..., sides[0], :], positions[..., sides[1], :]
    below = 0.5 * (left + right) if base is None else positions[..., base, :]
    y = rot.unit(left - right)
    x = rot.unit(np.cross(y, positions[..., top, :] - below))
    return rot.from_matrix(np.stack([x, y, np.cross(x, y)], axis=-1))
