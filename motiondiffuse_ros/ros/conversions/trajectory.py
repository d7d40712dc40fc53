"""Joint and root trajectories as trajectory_msgs."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import Quaternion, Transform, Twist, Vector3
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory as JointTrajectoryMsg
from trajectory_msgs.msg import (
    JointTrajectoryPoint,
    MultiDOFJointTrajectory,
    MultiDOFJointTrajectoryPoint,
)

from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.robots.trajectory import JointTrajectory

ROOT_JOINT = "root"
"""Name of the free joint in the root trajectory."""


def joint_trajectory_to_message(trajectory: JointTrajectory, header: Header) -> JointTrajectoryMsg:
    """Write positions [rad], velocities [rad/s] and, if known, accelerations over time."""
    accelerations = trajectory.accelerations
    if accelerations is None:
        accelerations = np.empty((len(trajectory.times), 0))
    rows = (trajectory.positions, trajectory.velocities, accelerations)
    points = zip(trajectory.times, *(values.astype(float) for values in rows), strict=True)
    return JointTrajectoryMsg(
        header=header,
        joint_names=list(trajectory.joint_names),
        points=[
            JointTrajectoryPoint(
                # from bytes: number by number takes three quarters of the whole message's time
                positions=array("d", position.tobytes()),
                velocities=array("d", velocity.tobytes()),
                accelerations=array("d", acceleration.tobytes()),
                time_from_start=to_duration(t),
            )
            for t, position, velocity, acceleration in points
        ],
    )


def root_trajectory_to_message(
    trajectory: JointTrajectory, header: Header
) -> MultiDOFJointTrajectory:
    """Write the root's pose [m, quaternion] and twist [m/s, rad/s], both in the header's frame."""
    points = zip(
        trajectory.times,
        trajectory.root_position,
        trajectory.root_orientation,
        trajectory.root_linear_velocity,
        trajectory.root_angular_velocity,
        strict=True,
    )
    return MultiDOFJointTrajectory(
        header=header,
        joint_names=[ROOT_JOINT],
        points=[
            MultiDOFJointTrajectoryPoint(
                transforms=[
                    Transform(translation=vector_to_message(p), rotation=quaternion_to_message(q))
                ],
                velocities=[Twist(linear=vector_to_message(v), angular=vector_to_message(w))],
                time_from_start=to_duration(t),
            )
            for t, p, q, v, w in points
        ],
    )


def trajectory_from_messages(
    joints: JointTrajectoryMsg, root: MultiDOFJointTrajectory
) -> JointTrajectory:
    """Read both halves of a trajectory.

    Raises:
        InputError: If there are not two points, their times differ or do not increase from 0, a
            joint is named twice, or positions, velocities or root poses are missing, of the wrong
            size, not finite or no rotations.
    """
    times = np.array([to_seconds(point.time_from_start) for point in joints.points])
    if times.size < 2 or times[0] < 0.0 or not (np.diff(times) > 0.0).all():
        raise InputError("a trajectory needs two points or more, of increasing times from 0")
    if len(set(joints.joint_names)) < len(joints.joint_names):
        raise InputError("a trajectory names a joint twice")
    if [point.time_from_start for point in root.points] != [
        point.time_from_start for point in joints.points
    ]:
        raise InputError("joint and root trajectory have different times")
    if any(len(p.transforms) != 1 or len(p.velocities) != 1 for p in root.points):
        raise InputError("every point of the root trajectory needs one transform and one velocity")
    poses = [point.transforms[0] for point in root.points]
    twists = [point.velocities[0] for point in root.points]
    shape = (len(times), len(joints.joint_names))
    return JointTrajectory(
        joint_names=tuple(joints.joint_names),
        times=times,
        positions=_table([point.positions for point in joints.points], shape, "positions"),
        velocities=_table([point.velocities for point in joints.points], shape, "velocities"),
        root_position=_vectors([pose.translation for pose in poses]),
        root_orientation=_unit([pose.rotation for pose in poses]),
        root_linear_velocity=_vectors([twist.linear for twist in twists]),
        root_angular_velocity=_vectors([twist.angular for twist in twists]),
    )


def to_duration(seconds: float) -> Duration:
    """Write a time span of zero or more [s], to the nearest nanosecond."""
    whole, nanoseconds = divmod(round(seconds * 1e9), 10**9)
    return Duration(sec=whole, nanosec=nanoseconds)


def to_time(seconds: float) -> Time:
    """Write a time since the clock's zero [s]."""
    duration = to_duration(seconds)
    return Time(sec=duration.sec, nanosec=duration.nanosec)


def to_seconds(duration: Duration) -> float:
    """Read a time span [s]."""
    return duration.sec + duration.nanosec * 1e-9


def quaternion_to_message(wxyz: np.ndarray) -> Quaternion:
    """Write a unit quaternion; ours are wxyz, the message's fields have names."""
    w, x, y, z = wxyz.tolist()
    return Quaternion(w=w, x=x, y=y, z=z)


def vector_to_message(xyz: np.ndarray) -> Vector3:
    """Write a vector [3]."""
    x, y, z = xyz.tolist()
    return Vector3(x=x, y=y, z=z)


def _vectors(messages: list[Vector3]) -> np.ndarray:
    return _finite(np.array([(v.x, v.y, v.z) for v in messages]), "root")


def _unit(messages: list[Quaternion]) -> np.ndarray:
    values = _finite(np.array([(q.w, q.x, q.y, q.z) for q in messages]), "root")
    with np.errstate(over="ignore"):
        norms = np.linalg.norm(values, axis=1)
    if (np.abs(norms - 1.0) > 1e-3).any():
        raise InputError("every orientation of the root must be a unit quaternion")
    return values


def _table(rows: Sequence[Sequence[float]], shape: tuple[int, int], what: str) -> np.ndarray:
    if any(len(row) != shape[1] for row in rows):
        raise InputError(f"every point needs {shape[1]} joint {what}")
    return _finite(np.array(rows, dtype=float).reshape(shape), f"joint {what}")


def _finite(values: np.ndarray, what: str) -> np.ndarray:
    if not np.isfinite(values).all():
        raise InputError(f"{what} holds values that are not finite")
    return values
