"""What the planner must know about a robot, and how a model and a few tables become that."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import product

import mujoco
import numpy as np

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.torque_limits import torque_limits

_HINGES = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)


@dataclass(frozen=True)
class RobotDescription:
    """All that a robot adds to its MuJoCo model.

    Attributes:
        name: What requests call it.
        model: Returns the model; its first joint is the free joint of the floating base, and
            positions and torques are limited there (joint `range`; actuator `forcerange`, joint
            `actuatorfrcrange` or a motor's `ctrlrange`).
        speed_limits: Largest joint speeds, rad/s, by joint name.
        rest: Joint positions of an upright stance, rad, by joint name; others are 0.
        body_map: Which body or, for "ik", site follows which canonical joint.
        retargeting: "exact" where the joints are the canonical skeleton's own, else "ik".
        t_pose: Joint positions of the canonical T-pose, rad, by joint name; others are 0. For "ik".
    """

    name: str
    model: Callable[[], mujoco.MjModel] = field(repr=False)
    speed_limits: Mapping[str, float] = field(repr=False)
    rest: Mapping[str, float] = field(repr=False)
    body_map: Mapping[str, str] = field(repr=False)
    retargeting: str = "exact"
    t_pose: Mapping[str, float] = field(default_factory=dict, repr=False)


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot ready for use; J actuated joints in the order of the model's `qpos[7:]`.

    Attributes:
        name: What requests call it: a name, or the path of its description.
        model: The MuJoCo model, shared: do not change it.
        joint_names: [J].
        lower: Lower position limits [J], rad.
        upper: Upper position limits [J], rad.
        velocity_limits: Largest speeds [J], rad/s.
        torque_limits: Largest torques [J], N m.
        rest_positions: An upright stance [J], rad.
        description: What it was loaded from.
    """

    name: str
    model: mujoco.MjModel = field(repr=False)
    joint_names: tuple[str, ...] = field(repr=False)
    lower: Array = field(repr=False)
    upper: Array = field(repr=False)
    velocity_limits: Array = field(repr=False)
    torque_limits: Array = field(repr=False)
    rest_positions: Array = field(repr=False)
    description: RobotDescription = field(repr=False)

    @property
    def is_canonical(self) -> bool:
        """Whether its joints are the canonical skeleton's own."""
        return self.description.retargeting == "exact"


def load_robot(description: RobotDescription) -> Robot:
    """Compile a description and check that it is complete.

    Raises:
        RobotError: If the model has no floating base first, or a joint has no position, speed or
            torque limit, or a table names joints that are not there.
    """
    model = description.model()
    kinds = model.jnt_type
    if model.njnt < 2 or kinds[0] != mujoco.mjtJoint.mjJNT_FREE:
        raise RobotError(
            f"robot '{description.name}': the model's first joint must be a free joint"
        )
    if not np.isin(kinds[1:], _HINGES).all():
        raise RobotError(f"robot '{description.name}': joints after the base must have one axis")
    names = tuple(model.joint(j).name for j in range(1, model.njnt))
    for table in (description.speed_limits, description.rest):
        if unknown := sorted(set(table) - set(names)):
            raise RobotError(f"robot '{description.name}': no joints {unknown} in the model")
    torque = torque_limits(model)
    for problem, missing in (
        ("position limit", ~model.jnt_limited[1:].astype(bool)),
        ("speed limit", np.array([name not in description.speed_limits for name in names])),
        ("torque limit", ~np.isfinite(torque)),
    ):
        if missing.any():
            first = names[int(np.argmax(missing))]
            raise RobotError(f"robot '{description.name}': joint '{first}' has no {problem}")
    return Robot(
        name=description.name,
        model=model,
        joint_names=names,
        lower=model.jnt_range[1:, 0].copy(),
        upper=model.jnt_range[1:, 1].copy(),
        velocity_limits=np.array([description.speed_limits[name] for name in names]),
        torque_limits=torque,
        rest_positions=np.array([description.rest.get(name, 0.0) for name in names]),
        description=description,
    )


def standing_on_floor(model: mujoco.MjModel, joints: Array) -> None:
    """Raise or lower a model's initial floating base so that its lowest solid is at z = 0.

    Args:
        model: With a free joint first.
        joints: Positions of the other joints [J], rad.
    """
    data = mujoco.MjData(model)
    data.qpos[7:] = joints
    mujoco.mj_kinematics(model, data)
    lowest = min(
        float((points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])[:, 2].min())
        for geom in range(model.ngeom)
        if (points := solid_points(model, geom)) is not None
    )
    model.qpos0[2] -= lowest


def solid_points(model: mujoco.MjModel, geom: int) -> Array | None:
    """Return points that span a geom that collides [P, 3], in its frame, m; None for others."""
    body = int(model.geom_bodyid[geom])
    if body == 0 or not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
        return None
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        first = int(model.mesh_vertadr[mesh])
        return model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])].astype(float)
    centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
    return centre + half * np.array(list(product((-1.0, 1.0), repeat=3)))
