"""States of any floating-base MJCF, as the measures need them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.floor_points import FloorPoints
from motiondiffuse_ros.physics.measures import RATE
from motiondiffuse_ros.physics.torque_limits import torque_limits

_ONE_AXIS = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)
_RIM = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)


@dataclass(frozen=True, eq=False)
class ModelLimits:
    """Limits of the joints after the free one [K]; infinite where the model states none."""

    lower: Array = field(repr=False)
    upper: Array = field(repr=False)
    velocity_limits: Array = field(repr=False)
    torque_limits: Array = field(repr=False)


@dataclass(frozen=True, eq=False)
class _Points:
    geoms: NDArray[np.intp]
    offsets: Array
    radii: Array


def load_mjcf(path: Path) -> mujoco.MjModel:
    """Compile an MJCF file.

    Raises:
        InputError: If it is missing or broken; the message holds what MuJoCo says.
    """
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise InputError(f"{path}: not a usable MJCF: {error}") from error


def mjcf_states(
    model: mujoco.MjModel,
    qpos: Array,
    fps: float,
    *,
    feet: Sequence[str],
    velocity_limits: Array | None = None,
) -> BodyStates:
    """Prepare states for `measures.measure`, at `RATE`.

    Args:
        model: A free joint first, then K joints of one axis each.
        qpos: [T, 7 + K], finite.
        fps: Frames per second of `qpos`.
        feet: Names of the bodies whose solids are the soles.
        velocity_limits: Of the K joints, rad/s; no limit if None.

    Raises:
        InputError: If the model has another structure, `qpos` another shape, or a foot no solid.
    """
    _check(model, qpos, fps)
    qpos = resample_states(np.asarray(qpos, dtype=np.float64), fps, RATE)
    points = _solid_points(model)
    places, bodies_at = _world(model, qpos, points)
    bodies = model.geom_bodyid[points.geoms].astype(np.intp)
    soles = [places[:, _of_foot(model, bodies, name)] for name in feet]
    names = [model.body(b).name for b in range(model.nbody)]
    return BodyStates(
        model=model,
        qpos=qpos,
        fps=RATE,
        limits=_limits(model, velocity_limits),
        joint_names=[model.joint(j).name for j in range(1, model.njnt)],
        points=FloorPoints(places, bodies),
        point_names=[names[b] for b in bodies],
        feet=np.stack([_middle_of_sole(sole) for sole in soles], axis=1),
        foot_names=list(feet),
        soles=soles,
        places=bodies_at[:, 1:],
        place_names=names[1:],
    )


def resample_states(qpos: Array, fps: float, rate: float) -> Array:
    """Return states [T, 7 + K] at another rate; quaternions normalised, of one hemisphere."""
    root = rot.continuous(rot.normalise(qpos[:, 3:7]))
    qpos = np.concatenate([qpos[:, :3], root, qpos[:, 7:]], axis=1)
    if fps == rate or len(qpos) < 2:
        return qpos
    times = np.arange(int((len(qpos) - 1) * rate / fps + 1e-6) + 1) * fps / rate
    first = np.minimum(times.astype(int), len(qpos) - 2)
    share = times - first
    out = qpos[first] + share[:, None] * (qpos[first + 1] - qpos[first])
    out[:, 3:7] = rot.slerp(qpos[first, 3:7], qpos[first + 1, 3:7], share)
    return out


def _check(model: mujoco.MjModel, qpos: Array, fps: float) -> None:
    kinds = model.jnt_type
    if not len(kinds) or kinds[0] != mujoco.mjtJoint.mjJNT_FREE:
        raise InputError("the model's first joint must be the free joint of a floating base")
    if not np.isin(kinds[1:], _ONE_AXIS).all():
        raise InputError("the model's joints after the base must be hinges or slides")
    if np.ndim(qpos) != 2 or np.shape(qpos)[1] != model.nq:
        raise InputError(f"qpos must be [frames, {model.nq}] for this model, got {np.shape(qpos)}")
    if not fps > 0.0:
        raise InputError(f"fps must be positive, got {fps}")


def _of_foot(model: mujoco.MjModel, bodies: NDArray[np.intp], name: str) -> NDArray[np.intp]:
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if body < 0:
        known = ", ".join(model.body(b).name for b in range(1, model.nbody))
        raise InputError(f"the model has no body '{name}' to be a foot; it has {known}")
    columns = np.flatnonzero(bodies == body)
    if not len(columns):
        raise InputError(f"the foot '{name}' has no geom that collides")
    return columns


def _middle_of_sole(sole: Array) -> Array:
    """Return the mean of the points of a sole over the floor [T, 3], at the lowest one's height."""
    middle = sole.mean(axis=1)
    middle[:, 2] = sole[..., 2].min(axis=1)
    return middle


@lru_cache(maxsize=8)
def _solid_points(model: mujoco.MjModel) -> _Points:
    """Return spheres that bound the model's colliding geoms from below."""
    geoms: list[int] = []
    offsets: list[Array] = []
    radii: list[float] = []
    for geom in range(model.ngeom):
        collides = model.geom_contype[geom] or model.geom_conaffinity[geom]
        if model.geom_bodyid[geom] == 0 or not collides:
            continue
        points, radius = _geom_points(model, geom)
        geoms += [geom] * len(points)
        offsets.append(points)
        radii += [radius] * len(points)
    if not geoms:
        raise InputError("the model has no geom that collides: nothing can touch the floor")
    return _Points(np.array(geoms), np.concatenate(offsets), np.array(radii))


def _geom_points(model: mujoco.MjModel, geom: int) -> tuple[Array, float]:
    kinds, size = mujoco.mjtGeom, model.geom_size[geom]
    match model.geom_type[geom]:
        case kinds.mjGEOM_SPHERE:
            return np.zeros((1, 3)), float(size[0])
        case kinds.mjGEOM_CAPSULE:
            return np.array([[0, 0, -size[1]], [0, 0, size[1]]]), float(size[0])
        case kinds.mjGEOM_CYLINDER:
            rim = size[0] * np.stack([np.cos(_RIM), np.sin(_RIM), 0.0 * _RIM], axis=-1)
            end = np.array([0.0, 0.0, size[1]])
            return np.concatenate([rim - end, rim + end]), 0.0
        case kinds.mjGEOM_MESH:
            return _mesh_points(model, int(model.geom_dataid[geom])), 0.0
        case _:
            centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
            return centre + half * np.array(list(product((-1.0, 1.0), repeat=3))), 0.0


def _mesh_points(model: mujoco.MjModel, mesh: int) -> Array:
    """Return the vertices of a mesh that are farthest in some direction."""
    first = int(model.mesh_vertadr[mesh])
    vertices = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])].astype(np.float64)
    directions = np.array([d for d in product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
    return vertices[np.unique((vertices @ directions.T).argmax(axis=0))]


def _world(model: mujoco.MjModel, qpos: Array, points: _Points) -> tuple[Array, Array]:
    """Return the lowest places of the points [T, P, 3] and the places of all bodies [T, B, 3]."""
    data = mujoco.MjData(model)
    places = np.empty((len(qpos), len(points.geoms), 3))
    bodies = np.empty((len(qpos), model.nbody, 3))
    for i, state in enumerate(qpos):
        data.qpos = state
        mujoco.mj_kinematics(model, data)
        turn = data.geom_xmat[points.geoms].reshape(-1, 3, 3)
        places[i] = data.geom_xpos[points.geoms] + (turn @ points.offsets[..., None])[..., 0]
        bodies[i] = data.xpos
    places[..., 2] -= points.radii
    return places, bodies


def _limits(model: mujoco.MjModel, velocity_limits: Array | None) -> ModelLimits:
    joints = slice(1, model.njnt)
    limited = model.jnt_limited[joints].astype(bool)
    endless = np.full(model.njnt - 1, np.inf)
    return ModelLimits(
        lower=np.where(limited, model.jnt_range[joints, 0], -endless),
        upper=np.where(limited, model.jnt_range[joints, 1], endless),
        velocity_limits=endless if velocity_limits is None else velocity_limits,
        torque_limits=torque_limits(model),
    )
