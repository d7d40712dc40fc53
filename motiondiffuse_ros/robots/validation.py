"""The promises of a `JointTrajectory`, checked.

The rules are those that ros2_control's joint_trajectory_controller applies to an incoming
trajectory (known names once each, equal sizes, strictly increasing times, last velocity zero) and
those that it does not: finite values, limits, and velocities that belong to the positions.
"""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.trajectory import JointTrajectory

_ROUNDING = 1e-9
_CONSISTENCY = 0.01


def broken_promises(trajectory: JointTrajectory, robot: Robot) -> tuple[str, ...]:
    """Return what is wrong with a trajectory for a robot, one line each; empty when all holds."""
    names, n, j = trajectory.joint_names, len(trajectory.times), len(trajectory.joint_names)
    if names != robot.joint_names:
        return (f"joint names {names} are not the robot's {robot.joint_names}",)
    shapes = {
        "times": (n,),
        "positions": (n, j),
        "velocities": (n, j),
        "root_position": (n, 3),
        "root_orientation": (n, 4),
        "root_linear_velocity": (n, 3),
        "root_angular_velocity": (n, 3),
    }
    if trajectory.accelerations is not None:
        shapes["accelerations"] = (n, j)
    values = {name: getattr(trajectory, name) for name in shapes}
    wrong = [
        f"{name} has shape {values[name].shape}, not {shape}"
        for name, shape in shapes.items()
        if values[name].shape != shape
    ]
    if n < 2:
        wrong.append(f"a trajectory needs two points or more, got {n}")
    if wrong:
        return tuple(wrong)
    wrong += [f"{name} is not finite" for name, v in values.items() if not np.isfinite(v).all()]
    if wrong:
        return tuple(wrong)

    times, positions, velocities = trajectory.times, trajectory.positions, trajectory.velocities
    if times[0] != 0.0 or not (np.diff(times) > 0.0).all():
        wrong.append("times do not increase strictly from 0")
    for name in ("velocities", "root_linear_velocity", "root_angular_velocity"):
        if values[name][-1].any():
            wrong.append(f"the last point of {name} is not zero")
    if np.abs(np.linalg.norm(trajectory.root_orientation, axis=1) - 1.0).max() > 1e-6:
        wrong.append("root_orientation holds quaternions that are not of unit length")
    below, above = robot.lower - positions, positions - robot.upper
    for what, excess in (
        ("position limit", np.maximum(below, above)),
        ("velocity limit", np.abs(velocities) - robot.velocity_limits),
    ):
        point, joint = np.unravel_index(int(np.argmax(excess)), excess.shape)
        if excess[point, joint] > _ROUNDING:
            wrong.append(
                f"{names[joint]} is {excess[point, joint]:.3g} beyond its {what} "
                f"at {times[point]:.2f} s"
            )
    if wrong:
        return tuple(wrong)
    steps = (positions[2:] - positions[:-2]) / (times[2:] - times[:-2])[:, None]
    error = np.abs(steps - velocities[1:-1]).max(initial=0.0)
    if error > _CONSISTENCY * max(np.abs(velocities).max(), 1e-3):
        wrong.append(f"velocities differ from the positions' differences by {error:.3g} rad/s")
    return tuple(wrong)
