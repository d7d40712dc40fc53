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

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.optimize import nnls

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.geometry import body_probes
from motiondiffuse_ros.physics.humanoid import humanoid_model
from motiondiffuse_ros.physics.state import motion_to_qpos, state_velocities

CONTACT_HEIGHT = 0.04
"""A point of the body below this [m] may push against the floor."""

FRICTION = 1.0
"""Coefficient of the friction cones (shoes on a dry floor)."""

_EDGES = np.array([[FRICTION, 0, 1], [-FRICTION, 0, 1], [0, FRICTION, 1], [0, -FRICTION, 1]])
# spreads the load over the points that could carry it; without, any one of many answers comes
_SPREAD = 0.02


@dataclass(frozen=True, eq=False)
class Dynamics:
    """What the inner frames 1 to T - 2 of a motion need.

    Attributes:
        residual_force: Norm of the force the floor cannot supply [T - 2], body weights.
        residual_torque: Norm of the torque about the centre of mass the floor cannot supply
            [T - 2], body weights times metre.
        torques: Joint torques with the floor's forces acting [T - 2, 63], N m.
        supported: Whether anything may push against the floor [T - 2].
    """

    residual_force: Array = field(repr=False)
    residual_torque: Array = field(repr=False)
    torques: Array = field(repr=False)
    supported: NDArray[np.bool_] = field(repr=False)


def inverse_dynamics(motion: Motion) -> Dynamics:
    """Find the forces behind a motion of three frames or more by central differences.

    A point counts as touching if it does so in the frame itself or a neighbour of it: the
    differences look that far.
    """
    model = _free_model()
    data = mujoco.MjData(model)
    qpos = motion_to_qpos(motion)
    qvel, qacc = state_velocities(qpos, motion.fps)
    probes = body_probes()
    points = probes.centres(motion)
    points[..., 2] -= probes.radii
    touching = maximum_filter1d(points[..., 2] < CONTACT_HEIGHT, 3, axis=0)
    bodies = np.array([model.body(CANONICAL.names[j]).id for j in probes.joints])
    weight = float(model.body_subtreemass[1] * np.linalg.norm(model.opt.gravity))

    frames = motion.frames - 2
    force, torque = np.zeros(frames), np.zeros(frames)
    torques = np.empty((frames, model.nv - 6))
    for i in range(frames):
        data.qpos, data.qvel, data.qacc = qpos[i + 1], qvel[i], qacc[i]
        mujoco.mj_inverse(model, data)
        centre = data.subtree_com[1]
        needed = _root_wrench(data, centre)
        active = np.flatnonzero(touching[i + 1])
        where = points[i + 1, active]
        supplied, at_points = _floor_forces(needed, where - centre, weight)
        left = needed - supplied
        force[i] = np.linalg.norm(left[:3]) / weight
        torque[i] = np.linalg.norm(left[3:]) / weight
        generalised = np.zeros(model.nv)
        for point, body, push in zip(where, bodies[active], at_points, strict=True):
            if push.any():
                mujoco.mj_applyFT(model, data, push, np.zeros(3), point, body, generalised)
        torques[i] = (data.qfrc_inverse - generalised)[6:]
    return Dynamics(force, torque, torques, np.any(touching[1:-1], axis=1))


def _free_model() -> mujoco.MjModel:
    """The humanoid without contacts and limits: what it takes to move, nothing to lean on."""
    model = copy(humanoid_model())
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    return model


def _root_wrench(data: mujoco.MjData, centre: Array) -> Array:
    """Return the force and the torque about the centre of mass, in the world, on the root."""
    force = data.qfrc_inverse[:3]
    # a free joint's rotational coordinates are in the body's own frame
    torque = rot.rotate(data.qpos[3:7], data.qfrc_inverse[3:6])
    return np.concatenate([force, torque + np.cross(data.qpos[:3] - centre, force)])


def _floor_forces(needed: Array, arms: Array, weight: float) -> tuple[Array, Array]:
    """Return the nearest wrench that points at arms [P, 3] can give, and their forces [P, 3]."""
    if not len(arms):
        return np.zeros(6), np.zeros((0, 3))
    forces = np.tile(_EDGES, (len(arms), 1))
    moments = np.cross(np.repeat(arms, len(_EDGES), axis=0), forces)
    columns = np.concatenate([forces, moments], axis=1).T
    count = columns.shape[1]
    system = np.vstack([columns, _SPREAD * np.eye(count)])
    shares, _ = nnls(system, np.concatenate([needed / weight, np.zeros(count)]))
    pushes = (shares * weight)[:, None] * forces
    return columns @ (shares * weight), pushes.reshape(len(arms), len(_EDGES), 3).sum(axis=1)
