"""From a motion to a trajectory that keeps a robot's limits and ends at rest."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.robots.retargeting import RobotMotion, retarget
from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.time_scaling import come_to_rest, slow_down
from motiondiffuse_ros.robots.trajectory import JointTrajectory

STOP_WINDOW = 0.5
"""The trajectory slows to rest over its last half second."""

SOFT_LIMIT = np.radians(2.0)
"""Positions bend away from a limit over the last two degrees before it."""

_SPEED_MARGIN = 0.99
"""Speeds are checked on a grid of path times; between its points they may be a little higher."""


def build_trajectory(robot: Robot, motion: Motion, rate: float = 50.0) -> JointTrajectory:
    """Sample a motion for a robot's controller.

    C2 splines through the retargeted frames; it starts at the first frame with that frame's
    velocity and comes to rest at its end within the same duration, by passing the path's last
    half second at a pace that falls from 1 to 0 (its last quarter second is never reached). Feet
    stay on their path. Positions are bent softly into their limits, and where a joint would be
    too fast the whole body slows down for a moment; `notes` says so.

    Args:
        robot: Who moves.
        motion: Finite; one frame yields a trajectory that holds it.
        rate: Points a second.

    Raises:
        RobotError: If the rate is not positive, the motion not finite, or the robot cannot take
            such motions.
    """
    if not (np.isfinite(rate) and rate > 0.0):
        raise RobotError(f"a trajectory needs a positive rate in Hz, got {rate}")
    if not (np.isfinite(motion.root).all() and np.isfinite(motion.rotations).all()):
        raise RobotError("the motion holds values that are not finite; nothing can follow it")
    frames = retarget(robot, motion)
    joints, notes = _inside_limits(robot, frames.joints)
    if motion.frames == 1:
        frames = RobotMotion(*(np.repeat(a, 2, axis=0) for a in _arrays(frames)), fps=rate)
        joints = np.repeat(joints, 2, axis=0)
        notes.append("the motion is a single frame: the trajectory holds it")

    knots = np.arange(len(joints)) / frames.fps
    path = CubicSpline(knots, joints)
    end = float(knots[-1])
    schedule, slowed_end = slow_down(path, end, _SPEED_MARGIN * robot.velocity_limits)
    if slowed_end - end > 1e-6:
        fast = np.max(np.abs(path(np.linspace(0, end, 10 * len(knots)), 1)), axis=0)
        worst = int(np.argmax(fast / robot.velocity_limits))
        notes.append(
            f"slowed by {slowed_end - end:.2f} s in all: {robot.joint_names[worst]} would turn at "
            f"{fast[worst]:.1f} rad/s, its limit is {robot.velocity_limits[worst]:.1f} rad/s"
        )
    points = max(1, int(np.ceil(slowed_end * rate - 1e-9)))
    times = np.arange(points + 1) / rate
    warped = come_to_rest(times, times[-1], min(STOP_WINDOW, float(times[-1])))
    path_times = np.clip(schedule(np.minimum(warped, slowed_end)), 0.0, end)

    positions = _soft_clamp(path(path_times), robot.lower, robot.upper)
    root_position = CubicSpline(knots, frames.root_position)(path_times)
    turns = Rotation.from_quat(frames.root_orientation, scalar_first=True)
    orientation = RotationSpline(knots, turns)(path_times).as_quat(scalar_first=True)
    orientation = rot.continuous(orientation)
    # only the first, extrapolated from the points after it, can be beyond the limit
    speeds = np.clip(_differences(positions, rate), -robot.velocity_limits, robot.velocity_limits)
    return JointTrajectory(
        joint_names=robot.joint_names,
        times=times,
        positions=positions,
        velocities=_to_rest(speeds),
        root_position=root_position,
        root_orientation=orientation,
        root_linear_velocity=_to_rest(_differences(root_position, rate)),
        root_angular_velocity=_to_rest(_spin(orientation, rate)),
        notes=tuple(notes),
    )


def _inside_limits(robot: Robot, joints: Array) -> tuple[Array, list[str]]:
    beyond = np.maximum(robot.lower - joints, joints - robot.upper).max(axis=0)
    notes = [
        f"{robot.joint_names[j]} held at its limit, the motion goes {np.degrees(beyond[j]):.0f} "
        "degrees beyond it"
        for j in np.flatnonzero(beyond > SOFT_LIMIT)
    ]
    return np.clip(joints, robot.lower, robot.upper), notes


def _soft_clamp(positions: Array, lower: Array, upper: Array) -> Array:
    """Bend positions beyond limit - SOFT_LIMIT into the limit: C2 and strictly inside."""
    high = positions - (upper - SOFT_LIMIT)
    low = positions - (lower + SOFT_LIMIT)
    bent = np.where(
        high > 0, upper - SOFT_LIMIT + SOFT_LIMIT * np.tanh(high / SOFT_LIMIT), positions
    )
    return np.where(low < 0, lower + SOFT_LIMIT + SOFT_LIMIT * np.tanh(low / SOFT_LIMIT), bent)


def _differences(values: Array, rate: float) -> Array:
    """Central differences, second order at the ends where there are points enough."""
    return np.gradient(values, 1.0 / rate, axis=0, edge_order=2 if len(values) > 2 else 1)


def _spin(orientation: Array, rate: float) -> Array:
    """World angular velocity [N, 3], rad/s, by the same rule as `_differences`."""
    halves = rot.to_rotation_vector(rot.multiply(orientation[1:], rot.conjugate(orientation[:-1])))
    halves = halves * rate
    if len(halves) == 1:
        return np.repeat(halves, 2, axis=0)
    inner = 0.5 * (halves[1:] + halves[:-1])
    first = 1.5 * halves[:1] - 0.5 * halves[1:2]
    return np.concatenate([first, inner, np.zeros((1, 3))])


def _to_rest(velocities: Array) -> Array:
    velocities = velocities.copy()
    velocities[-1] = 0.0
    return velocities


def _arrays(frames: RobotMotion) -> tuple[Array, Array, Array]:
    return frames.root_position, frames.root_orientation, frames.joints
