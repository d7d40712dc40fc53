"""Which of a robot's solids must not touch, and whether they do between two poses."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from functools import cache

import mujoco
import numpy as np

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.robots.robot import Robot

DISTANCE = 0.006
"""That solids keep from each other [m]."""

OVERLAP = 0.005
"""Overlaps between two poses up to this [m] are let go."""

_FAST = 0.15  # joints that move less than this between two poses pass nothing [rad]


@cache
def self_collision_pairs(robot: Robot) -> tuple[tuple[int, int], ...]:
    """Return the pairs of geoms that must not touch.

    Those of different limbs, and of limbs and trunk, without pairs that touch in the T-pose or at
    rest.
    """
    model, sites = robot.model, robot.description.body_map
    limbs = [
        _geoms_below(model, model.site(sites[f"{side}_{joint}"]).bodyid[0])
        for side, joint in itertools.product(SIDES, ("shoulder", "hip"))
    ]
    trunk = _geoms_below(model, model.jnt_bodyid[0]) - set().union(*limbs)
    pairs = {
        (min(a, b), max(a, b))
        for one, other in itertools.combinations([trunk, *limbs], 2)
        for a, b in itertools.product(one, other)
    }
    touching = set().union(
        *(_near(robot, pairs, pose) for pose in (robot.description.t_pose, robot.description.rest))
    )
    return tuple(sorted(pairs - touching))


def _geoms_below(model: mujoco.MjModel, body: int) -> set[int]:
    """Return the geoms that collide of a body and all that hang on it."""
    below = {int(body)}
    for child in range(int(body) + 1, model.nbody):
        if int(model.body_parentid[child]) in below:
            below.add(child)
    solid = (model.geom_contype | model.geom_conaffinity).astype(bool)
    return {int(g) for g in np.flatnonzero(solid) if int(model.geom_bodyid[g]) in below}


def _near(
    robot: Robot, pairs: set[tuple[int, int]], pose: Mapping[str, float]
) -> set[tuple[int, int]]:
    data = mujoco.MjData(robot.model)
    data.qpos[7:] = [pose.get(name, 0.0) for name in robot.joint_names]
    mujoco.mj_kinematics(robot.model, data)
    return {
        pair
        for pair in pairs
        if mujoco.mj_geomDistance(robot.model, data, *pair, 2 * DISTANCE, None) < DISTANCE
    }


def overlaps_between(robot: Robot, joints: Array) -> bool:
    """Return whether solids overlap halfway between neighbouring poses [T, J], rad."""
    model, data = robot.model, mujoco.MjData(robot.model)
    kept = np.zeros((model.ngeom, model.ngeom), dtype=bool)
    for a, b in self_collision_pairs(robot):
        kept[a, b] = kept[b, a] = True
    fast = np.abs(np.diff(joints, axis=0)).max(axis=1, initial=0.0) > _FAST
    for frame in np.flatnonzero(fast):
        data.qpos[7:] = 0.5 * (joints[frame] + joints[frame + 1])
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        one, other = data.contact.geom.T
        if (kept[one, other] & (data.contact.dist < -OVERLAP)).any():
            return True
    return False
