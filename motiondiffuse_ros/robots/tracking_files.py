"""Trajectories in the files that whole-body trackers are trained on and fed with."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.robots.embodiment import embodiment
from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.trajectory import JointTrajectory

CONTACT_HEIGHT = 0.015
"""A corner of a sole below this [m] that is slower than `CONTACT_SPEED` is in contact."""

CONTACT_SPEED = 0.25
"""[m/s]."""


def save_tracking_csv(trajectory: JointTrajectory, path: Path) -> None:
    """Write rows as Unitree's LAFAN1 retargeting data set has them.

    No header; each row is the base's position [m] and quaternion xyzw, then the joints [rad] in
    the order of the model.
    """
    xyzw = trajectory.root_orientation[:, [1, 2, 3, 0]]
    rows = np.column_stack([trajectory.root_position, xyzw, trajectory.positions])
    np.savetxt(path, rows, fmt="%.6f", delimiter=",")


def save_tracking_npz(trajectory: JointTrajectory, robot: Robot, path: Path) -> None:
    """Write a motion file as mjlab's `csv_to_npz` does, for its tracking tasks.

    Keys: `fps` [1], `joint_pos` and `joint_vel` [N, J], `body_pos_w` [N, B, 3], `body_quat_w`
    [N, B, 4] (wxyz), `body_lin_vel_w` and `body_ang_vel_w` [N, B, 3], of the origins of the
    bodies' frames, in the world; joints and bodies in the order of the MuJoCo model, the world left
    out. Besides those, `joint_names`, `body_names` and, for robots with soles, `foot_names` and
    `foot_contacts` [N, 2].

    Raises:
        RobotError: If the points are not uniformly spaced, or the joints are not the robot's.
    """
    if trajectory.joint_names != robot.joint_names:
        raise RobotError(f"the trajectory's joints are not those of '{robot.name}'")
    steps = np.diff(trajectory.times)
    if len(steps) == 0 or np.ptp(steps) > 1e-6:
        raise RobotError("a motion file needs two points or more, uniformly spaced")
    model = robot.model
    bodies = [b for b in range(1, model.nbody) if model.body_rootid[b] == model.jnt_bodyid[0]]
    positions, orientations, linear, angular = _body_states(trajectory, robot, bodies)
    values = {
        "fps": np.array([round(1.0 / float(steps.mean()))]),
        "joint_pos": trajectory.positions,
        "joint_vel": trajectory.velocities,
        "body_pos_w": positions,
        "body_quat_w": orientations,
        "body_lin_vel_w": linear,
        "body_ang_vel_w": angular,
    }
    single = {k: v.astype(np.float32) if v.dtype.kind == "f" else v for k, v in values.items()}
    named = {
        "joint_names": np.array(robot.joint_names),
        "body_names": np.array([model.body(b).name for b in bodies]),
    }
    if not robot.is_canonical:
        named |= {
            "foot_names": np.array([f"{side}_foot" for side in SIDES]),
            "foot_contacts": foot_contacts(trajectory, robot),
        }
    np.savez_compressed(path, allow_pickle=False, **single, **named)


def foot_contacts(trajectory: JointTrajectory, robot: Robot) -> NDArray[np.bool_]:
    """Return whether a part of each sole rests on the floor at z = 0 [N, 2], left foot first."""
    body, model = embodiment(robot), robot.model
    flags = np.empty((len(trajectory.times), 2), dtype=bool)
    sites = [model.site(robot.description.body_map[f"{side}_ankle"]) for side in SIDES]
    feet = [int(site.bodyid[0]) for site in sites]
    positions, orientations, _, _ = _body_states(trajectory, robot, feet)
    for n, (side, site) in enumerate(zip(SIDES, sites, strict=True)):
        inside = site.pos + rot.rotate(site.quat, body.soles[side])
        corners = positions[:, n, None] + rot.rotate(orientations[:, n, None], inside)
        speed = np.linalg.norm(np.gradient(corners, trajectory.times, axis=0), axis=-1)
        resting = (corners[..., 2] < CONTACT_HEIGHT) & (speed < CONTACT_SPEED)
        flags[:, n] = resting.any(axis=1)
    return flags


def _body_states(
    trajectory: JointTrajectory, robot: Robot, bodies: list[int]
) -> tuple[Array, Array, Array, Array]:
    """Return positions, orientations, linear and angular velocities of bodies' frames."""
    model, data = robot.model, mujoco.MjData(robot.model)
    shape = (len(trajectory.times), len(bodies))
    positions, orientations = np.empty((*shape, 3)), np.empty((*shape, 4))
    twists, twist = np.empty((*shape, 6)), np.empty(6)
    # a free joint's angular velocity is in the body's frame
    spin = rot.rotate(rot.conjugate(trajectory.root_orientation), trajectory.root_angular_velocity)
    for n in range(shape[0]):
        data.qpos[:] = np.concatenate(
            [
                trajectory.root_position[n],
                trajectory.root_orientation[n],
                trajectory.positions[n],
            ]
        )
        data.qvel[:] = np.concatenate(
            [trajectory.root_linear_velocity[n], spin[n], trajectory.velocities[n]]
        )
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        positions[n], orientations[n] = data.xpos[bodies], data.xquat[bodies]
        for m, body in enumerate(bodies):
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, twist, 0)
            twists[n, m] = twist
    return positions, orientations, twists[..., 3:], twists[..., :3]
