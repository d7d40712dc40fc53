"""What the planner must know about a robot, and how a model and a few tables become that."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import mujoco
import numpy as np

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion.rotations import Array

_HINGES = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)


@dataclass(frozen=True)
class RobotDescription:
    """All that a robot adds to its MuJoCo model.

    Attributes:
        name: What requests call it.
        model: Compiles the model; its first joint is the free joint of the floating base, and
            positions and torques are limited there (joint `range`, actuator `forcerange`).
        speed_limits: Largest joint speeds, rad/s, by joint name.
        rest: Joint positions of an upright stance, rad, by joint name; others are 0.
        body_map: Which body follows which canonical joint.
        retargeting: "exact" where the joints are the canonical skeleton's own.
    """

    name: str
    model: Callable[[], mujoco.MjModel] = field(repr=False)
    speed_limits: Mapping[str, float] = field(repr=False)
    rest: Mapping[str, float] = field(repr=False)
    body_map: Mapping[str, str] = field(repr=False)
    retargeting: str = "exact"


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot ready for use; J actuated joints in the order of the model's `qpos[7:]`.

    Attributes:
        name: What requests call it.
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
    torque = _torque_limits(model)
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


def _torque_limits(model: mujoco.MjModel) -> Array:
    limits = np.full(model.njnt, np.inf)
    for a in range(model.nu):
        if model.actuator_forcelimited[a]:
            limits[model.actuator_trnid[a, 0]] = model.actuator_forcerange[a, 1]
    return limits[1:]
