"""Which forces a motion needs, and which of them a floor can give.

Inverse dynamics (MuJoCo's `mj_inverse`) yields the wrench that would have to act on the root for
the motion to happen. A person has no such hand of God: the floor must supply it, through points of
the body that touch it, by forces inside their friction cones. The non-negative least squares
problem over the cones' edges finds the best the floor can do; what is left is the root residual
wrench. A flight that is ballistic needs nothing and leaves nothing; a hover, a lean beyond the
feet, or a body that accelerates without pushing off leaves much.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array, cross
from motiondiffuse_ros.physics.balance import Balance, balance
from motiondiffuse_ros.physics.body_states import BodyStates, humanoid_states
from motiondiffuse_ros.physics.floor_forces import floor_forces
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.state import state_velocities

_ROOT = 6  # degrees of freedom of a free root
_NO_TORQUE = np.zeros(3)


@dataclass(frozen=True, eq=False)
class Dynamics:
    """What the inner frames 1 to T - 2 of a motion need; K joints beside the root.

    Attributes:
        residual_force: Norm of the force the floor cannot supply [T - 2], body weights.
        residual_torque: Norm of the torque about the centre of mass the floor cannot supply
            [T - 2], body weights times metre.
        torques: Joint torques with the floor's forces acting [T - 2, K], N m.
        power: Of each joint [T - 2, K], W; negative where it brakes.
        centre: Centre of mass [T - 2, 3], m.
        supported: Whether anything may push against the floor [T - 2].
        poise: Where the centre is over what touches the floor.
    """

    residual_force: Array = field(repr=False)
    residual_torque: Array = field(repr=False)
    torques: Array = field(repr=False)
    power: Array = field(repr=False)
    centre: Array = field(repr=False)
    supported: NDArray[np.bool_] = field(repr=False)
    poise: Balance = field(repr=False)


def inverse_dynamics(motion: Motion) -> Dynamics:
    """Find the forces behind a motion of three frames or more, of the humanoid."""
    return state_dynamics(humanoid_states(motion, hinge_table()))


def state_dynamics(states: BodyStates) -> Dynamics:
    """Find the forces behind three states or more of any body, by central differences."""
    model, qpos, points = _without_contact(states.model), states.qpos, states.points
    data = mujoco.MjData(model)
    qvel, qacc = state_velocities(qpos, states.fps)
    frames = len(qpos) - 2
    needed, centre = np.empty((frames, model.nv)), np.empty((frames, 3))
    turns, supplied = np.empty((frames, 3, 3)), np.zeros((frames, model.nv))
    touching, places = points.touching()[1:-1], points.places[1:-1]
    weight = float(model.body_subtreemass[1] * np.linalg.norm(model.opt.gravity))
    for i in range(frames):
        data.qpos, data.qvel, data.qacc = qpos[i + 1], qvel[i], qacc[i]
        mujoco.mj_inverse(model, data)
        needed[i], centre[i] = data.qfrc_inverse, data.subtree_com[1]
        turns[i] = data.xmat[1].reshape(3, 3)
    wrench = _root_wrench(needed, turns, qpos[1:-1, :3] - centre) / weight
    used = touching.any(axis=0)  # most of a body never touches the floor
    left, pushes = floor_forces(wrench, places[:, used] - centre[:, None], touching[:, used])
    where, bodies = places[:, used], points.bodies[used]
    for i in range(frames):
        data.qpos = qpos[i + 1]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        for p in np.flatnonzero(pushes[i, :, 2] > 0.0):
            push = weight * pushes[i, p]
            mujoco.mj_applyFT(model, data, push, _NO_TORQUE, where[i, p], bodies[p], supplied[i])
    torques = (needed - supplied)[:, _ROOT:]
    return Dynamics(
        residual_force=np.linalg.norm(left[:, :3], axis=-1),
        residual_torque=np.linalg.norm(left[:, 3:], axis=-1),
        torques=torques,
        power=torques * qvel[:, _ROOT:],
        centre=centre,
        supported=np.any(touching, axis=1),
        poise=balance(centre, places, touching, states.fps),
    )


@lru_cache(maxsize=8)
def _without_contact(model: mujoco.MjModel) -> mujoco.MjModel:
    """Return a copy without contacts and limits: what it takes to move, nothing to lean on."""
    free = copy(model)
    free.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    return free


def _root_wrench(needed: Array, turns: Array, arms: Array) -> Array:
    """Return force and torque about the centre of mass [T, 6], in the world, on the root."""
    force = needed[:, :3]
    # a free joint's rotational coordinates are in the body's own frame
    torque = (turns @ needed[:, 3:6, None])[..., 0]
    return np.concatenate([force, torque + cross(arms, force)], axis=1)
