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
from motiondiffuse_ros.motion.spans import pieces
from motiondiffuse_ros.physics.balance import Balance, balance
from motiondiffuse_ros.physics.body_states import BodyStates, humanoid_states
from motiondiffuse_ros.physics.floor_forces import floor_forces
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.state import state_velocities

_ROOT = 6  # degrees of freedom of a free root
_FRAMES = 1024
"""Solved together: more take no less time each, and 30 kB each."""


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
    frames, weight = len(qpos) - 2, _weight(model)
    touching, places = points.touching()[1:-1], points.places[1:-1]
    used = touching.any(axis=0)  # most of a body never touches the floor
    leans_on = _moved_by(model)[points.bodies[used]]
    torques, centre = np.empty((frames, model.nv - _ROOT)), np.empty((frames, 3))
    left = np.empty((frames, 6))
    for at in pieces(frames, _FRAMES):
        count = at.stop - at.start
        needed, axes = np.empty((count, model.nv)), np.empty((count, model.nv, 6))
        turns = np.empty((count, 3, 3))
        for i, frame in enumerate(range(at.start, at.stop)):
            data.qpos, data.qvel, data.qacc = qpos[frame + 1], qvel[frame], qacc[frame]
            mujoco.mj_inverse(model, data)
            needed[i], centre[frame], axes[i] = data.qfrc_inverse, data.subtree_com[1], data.cdof
            turns[i] = data.xmat[1].reshape(3, 3)
        wrench = _root_wrench(needed, turns, qpos[1:-1, :3][at] - centre[at]) / weight
        arms = places[at][:, used] - centre[at, None]
        left[at], pushes = floor_forces(wrench, arms, touching[at][:, used])
        supplied = _generalised(weight * pushes, arms, axes, leans_on)
        torques[at] = (needed - supplied)[:, _ROOT:]
    return Dynamics(
        residual_force=np.linalg.norm(left[:, :3], axis=-1),
        residual_torque=np.linalg.norm(left[:, 3:], axis=-1),
        torques=torques,
        power=torques * qvel[:, _ROOT:],
        centre=centre,
        supported=np.any(touching, axis=1),
        poise=balance(centre, places, touching, states.fps),
    )


def _weight(model: mujoco.MjModel) -> float:
    """Return the body's weight, N."""
    return float(model.body_subtreemass[1] * np.linalg.norm(model.opt.gravity))


def _generalised(pushes: Array, arms: Array, axes: Array, moved: NDArray[np.bool_]) -> Array:
    """Return what forces at points do along each degree of freedom [T, nv], N m or N.

    Args:
        pushes: Force at each point [T, P, 3], N.
        arms: The points, from the centre of mass [T, P, 3], m.
        axes: MuJoCo's `cdof`: rotation, and motion of the centre of mass, for each degree of
            freedom [T, nv, 6].
        moved: Which degrees of freedom move each point [P, nv].
    """
    wrenches = np.concatenate([cross(arms, pushes), pushes], axis=-1)
    return (axes * (moved.T.astype(float) @ wrenches)).sum(axis=-1)


@lru_cache(maxsize=8)
def _moved_by(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Return which degrees of freedom move each body [nbody, nv]: its own and its parents'."""
    moved = np.zeros((model.nbody, model.nv), dtype=bool)
    for body in range(1, model.nbody):  # parents come first
        first = model.body_dofadr[body]
        moved[body] = moved[model.body_parentid[body]]
        moved[body, first : first + model.body_dofnum[body]] = True
    return moved


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
