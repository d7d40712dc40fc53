"""Whether a robot can stay in a pose: its centre of mass over what it stands on."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.physics.balance import balance
from motiondiffuse_ros.robots.robot import Robot, solid_points

TOUCHING = 0.03
"""Solids lower than this stand on the floor [m]: feet of motions hover a little."""

MARGIN = 0.01
"""By which the centre of mass has to lie inside the support [m]."""


@dataclass(frozen=True)
class Stance:
    """How a robot stands in one pose.

    Attributes:
        outside: Horizontal distance of the centre of mass from the hull of what touches the floor,
            negative inside, m; NaN where nothing does.
        lifted: Sides whose foot is in the air.
        on_feet: Whether nothing but feet touches the floor.
    """

    outside: float
    lifted: tuple[str, ...]
    on_feet: bool

    @property
    def is_stable(self) -> bool:
        """Whether it can be held: on both feet, or kneeling, sitting or lying."""
        return self.outside <= -MARGIN and not (self.on_feet and self.lifted)

    def __str__(self) -> str:
        """Say what is wrong with it, if anything is."""
        if np.isnan(self.outside):
            return "nothing touches the floor"
        if self.outside > 0.0:
            return f"the centre of mass is {100 * self.outside:.0f} cm outside the support"
        if self.outside > -MARGIN:
            return "the centre of mass is at the edge of the support"
        return "stable" if self.is_stable else f"the {self.lifted[0]} foot is in the air"


def stance(robot: Robot, qpos: Array) -> Stance:
    """Look at one pose [7 + J] on a floor at z = 0."""
    model, data = robot.model, mujoco.MjData(robot.model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    base = int(model.jnt_bodyid[0])
    feet = {side: _foot(robot, side) for side in SIDES}
    touching: list[Array] = []
    standing = set[int]()
    for geom in range(model.ngeom):
        points, body = solid_points(model, geom), int(model.geom_bodyid[geom])
        if points is None or model.body_rootid[body] != base:
            continue
        places = points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        low = places[places[:, 2] < TOUCHING]
        if len(low):
            touching.append(low)
            standing.add(body)
    outside = np.nan
    if touching:
        outside = _outside(data.subtree_com[base], np.concatenate(touching))
    return Stance(
        outside=outside,
        lifted=tuple(side for side, bodies in feet.items() if not bodies & standing),
        on_feet=standing <= set.union(*feet.values()),
    )


def _outside(centre: Array, support: Array) -> float:
    """Return the distance of a centre of mass that rests [3] from a support [P, 3], m."""
    twice = np.stack([support, support])  # a body at rest is one that stays
    touching = np.ones(twice.shape[:2], dtype=bool)
    return float(balance(np.stack([centre, centre]), twice, touching, 1.0).from_support[0])


def _foot(robot: Robot, side: str) -> set[int]:
    """Return the bodies of a foot: that of the ankle and what hangs on it."""
    model, name = robot.model, robot.description.body_map[f"{side}_ankle"]
    ankle = model.body(name).id if robot.is_canonical else int(model.site(name).bodyid[0])
    foot = {int(ankle)}
    for body in range(int(ankle) + 1, model.nbody):  # parents come before their children
        if int(model.body_parentid[body]) in foot:
            foot.add(body)
    return foot
