"""From a motion to a trajectory that keeps a robot's limits and ends at rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.robots.joining import MERGE, JoinedPaths, Paths, join
from motiondiffuse_ros.robots.retargeting import RobotMotion, retarget
from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.stance import stance
from motiondiffuse_ros.robots.standing_end import retarget_to_stand
from motiondiffuse_ros.robots.start_state import StartState
from motiondiffuse_ros.robots.time_scaling import come_to_rest, slow_down
from motiondiffuse_ros.robots.trajectory import JointTrajectory, Source

STOP_WINDOW = 0.5
"""The trajectory slows to rest over its last half second."""

SOFT_LIMIT = np.radians(2.0)
"""Positions bend away from a limit over the last two degrees before it."""

_LEAST_BEND = np.radians(0.05)
_SPEED_MARGIN = 0.99
"""Speeds are checked on a grid of path times; between its points they may be a little higher."""


def build_trajectory(
    robot: Robot,
    motion: Motion,
    rate: float = 50.0,
    start: StartState | None = None,
    *,
    accelerations: bool = False,
    settle: bool = True,
    progress: Callable[[float], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> JointTrajectory:
    """Sample a motion for a robot's controller.

    C2 splines through the retargeted frames; it starts at the first frame with that frame's
    velocity and comes to rest at its end within the same duration, by passing the path's last
    half second at a pace that falls from 1 to 0 (its last quarter second is never reached). Feet
    stay on their path. Positions are bent softly into their limits, and where a joint would be
    too fast the whole body slows down for a moment; `notes` says so.

    With a start state the first point has exactly its positions and velocities. The gap to the
    motion closes smoothly over half a second or a little more; one that is too wide for that is
    closed in an approach, and the motion follows after it.

    A motion that would come to rest with a foot in the air, or with its centre of mass outside its
    support, comes to stand first, in an ending that is appended (`settling`). `notes` says so, and
    what is wrong where the last pose can still not be held.

    Args:
        robot: Who moves.
        motion: Finite; one frame yields a trajectory that holds it.
        rate: Points a second.
        start: Where the robot is when the trajectory begins; None = at the motion's first frame.
        accelerations: Whether to give them too.
        settle: Whether a motion that ends in no stable stance comes to stand.
        progress: Told the share of the retargeting done, 0 to 1.
        cancelled: Asked while retargeting takes work.

    Raises:
        Cancelled: If `cancelled` says so.
        RobotError: If the rate is not positive, the motion or the start state not finite or of
            another robot, or the robot cannot take such motions.
    """
    if not (np.isfinite(rate) and rate > 0.0):
        raise RobotError(f"a trajectory needs a positive rate in Hz, got {rate}")
    if not (np.isfinite(motion.root).all() and np.isfinite(motion.rotations).all()):
        raise RobotError("the motion holds values that are not finite; nothing can follow it")
    if settle and motion.frames > 1:
        ended, frames = retarget_to_stand(robot, motion, STOP_WINDOW, progress, cancelled)
    else:
        ended, frames = motion, retarget(robot, motion, progress, cancelled)
    joints, notes = _inside_limits(robot, frames.joints)
    if ended is not motion:
        notes.append(f"comes to stand in the {ended.duration - motion.duration:.2f} s after it")
    if motion.frames == 1:
        frames = RobotMotion(*(np.repeat(a, 2, axis=0) for a in _arrays(frames)), fps=rate)
        joints = np.repeat(joints, 2, axis=0)
        notes.append("the motion is a single frame: the trajectory holds it")

    knots = np.arange(len(joints)) / frames.fps
    turns = Rotation.from_quat(frames.root_orientation, scalar_first=True)
    paths: Paths | JoinedPaths = Paths(
        CubicSpline(knots, joints),
        CubicSpline(knots, frames.root_position),
        RotationSpline(knots, turns),
        float(knots[-1]),
    )
    if start is not None:
        start, said = _checked(robot, start)
        paths = join(paths, start, _SPEED_MARGIN * robot.velocity_limits, STOP_WINDOW)
        notes += said + _joining_notes(paths)
    path, end = paths.joints, paths.end
    approach = paths.approach if isinstance(paths, JoinedPaths) else 0.0
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

    lower, upper = _bending(robot, start)
    positions = _soft_clamp(path(path_times), robot.lower, robot.upper, lower, upper)
    root_position = paths.root(path_times)
    orientation = rot.continuous(paths.orientation(path_times))
    # only the first, extrapolated from the points after it, can be beyond the limit
    speeds = np.clip(_differences(positions, rate), -robot.velocity_limits, robot.velocity_limits)
    linear, angular = _differences(root_position, rate), _spin(orientation, rate)
    if start is not None:
        positions[0], speeds[0] = start.positions, start.velocities
        if start.root is not None:
            linear[0], angular[0] = start.root.linear_velocity, start.root.angular_velocity
    speeds = _to_rest(speeds)
    if settle and motion.frames > 1:
        last = np.concatenate([root_position[-1], orientation[-1], positions[-1]])
        if not (found := stance(robot, last)).is_stable:
            notes.append(f"ends in a pose that cannot be held: {found}")
    return JointTrajectory(
        joint_names=robot.joint_names,
        times=times,
        positions=positions,
        velocities=speeds,
        root_position=root_position,
        root_orientation=orientation,
        root_linear_velocity=_to_rest(linear),
        root_angular_velocity=_to_rest(angular),
        notes=tuple(notes),
        accelerations=_differences(speeds, rate) if accelerations else None,
        source=Source(ended, np.clip(path_times - approach, 0.0, ended.duration)),
    )


def _checked(robot: Robot, start: StartState) -> tuple[StartState, list[str]]:
    """Return a start state inside the limits, and what had to be changed for that."""
    shape = (len(robot.joint_names),)
    if start.positions.shape != shape or start.velocities.shape != shape:
        raise RobotError(
            f"a start state of {robot.name} has {shape[0]} joint positions and velocities, got "
            f"{start.positions.shape} and {start.velocities.shape}"
        )
    root = () if start.root is None else vars(start.root).values()
    if not all(np.isfinite(a).all() for a in (start.positions, start.velocities, *root)):
        raise RobotError("the start state holds values that are not finite")
    positions = np.clip(start.positions, robot.lower, robot.upper)
    speeds = np.clip(start.velocities, -robot.velocity_limits, robot.velocity_limits)
    said = [
        f"{robot.joint_names[j]} starts at its limit, it is said to be "
        f"{np.degrees(abs(start.positions[j] - positions[j])):.0f} degrees beyond it"
        for j in np.flatnonzero(np.abs(start.positions - positions) > SOFT_LIMIT)
    ]
    return replace(start, positions=positions, velocities=speeds), said


def _joining_notes(joined: JoinedPaths) -> list[str]:
    if joined.approach > 0.0:
        return [f"starts with an approach of {joined.approach:.2f} s to the motion's first pose"]
    if joined.merge > MERGE:
        return [f"joins the motion over its first {joined.merge:.2f} s"]
    return []


def _inside_limits(robot: Robot, joints: Array) -> tuple[Array, list[str]]:
    beyond = np.maximum(robot.lower - joints, joints - robot.upper).max(axis=0)
    notes = [
        f"{robot.joint_names[j]} held at its limit, the motion goes {np.degrees(beyond[j]):.0f} "
        "degrees beyond it"
        for j in np.flatnonzero(beyond > SOFT_LIMIT)
    ]
    return np.clip(joints, robot.lower, robot.upper), notes


def _bending(robot: Robot, start: StartState | None) -> tuple[Array, Array]:
    """Return how far from the lower and the upper limits positions begin to bend [J], rad.

    Not where the robot starts, which is nearer to a limit if a bent trajectory has led there.
    """
    full = np.full(len(robot.joint_names), SOFT_LIMIT)
    if start is None:
        return full, full
    return (
        np.clip(start.positions - robot.lower, _LEAST_BEND, SOFT_LIMIT),
        np.clip(robot.upper - start.positions, _LEAST_BEND, SOFT_LIMIT),
    )


def _soft_clamp(
    positions: Array, lower: Array, upper: Array, low_width: Array, high_width: Array
) -> Array:
    """Bend positions within a width of a limit, and beyond it, into the limit: C2 and inside."""
    high = positions - (upper - high_width)
    low = positions - (lower + low_width)
    bent = np.where(
        high > 0, upper - high_width + high_width * np.tanh(high / high_width), positions
    )
    return np.where(low < 0, lower + low_width + low_width * np.tanh(low / low_width), bent)


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
