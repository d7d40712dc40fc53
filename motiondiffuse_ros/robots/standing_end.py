"""Retargeting of motions that are brought to stand where their end cannot be held."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.robots.registry import get_robot
from motiondiffuse_ros.robots.retargeting import RobotMotion, retarget
from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.settling import can_settle, settled
from motiondiffuse_ros.robots.stance import stance


def retarget_to_stand(
    robot: Robot,
    motion: Motion,
    stop_window: float,
    progress: Callable[[float], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> tuple[Motion, RobotMotion]:
    """Carry a motion over to a robot, with an ending if it would not come to rest stably.

    Args:
        robot: Who moves.
        motion: Two frames or more.
        stop_window: Time in which the robot slows to rest, halfway through this last part [s].
        progress: As `retarget`.
        cancelled: As `retarget`.

    Returns:
        The motion, with the ending if one was needed, and the robot's frames of it.

    Raises:
        RobotError: As `retarget`.
        Cancelled: If `cancelled` says so.
    """
    if not can_settle(motion):
        return motion, retarget(robot, motion, progress, cancelled)
    # the skeleton's own body tells without inverse kinematics what its robot will mostly do
    body = get_robot("humanoid")
    end = motion.slice(max(0, motion.frames - 2 - round(stop_window * motion.fps)), motion.frames)
    if stance(body, _at_rest(retarget(body, end), stop_window)).is_stable:
        frames = retarget(robot, motion, progress, cancelled)
        if robot.is_canonical or stance(robot, _at_rest(frames, stop_window)).is_stable:
            return motion, frames
    ended = settled(motion)
    return ended, retarget(robot, ended, progress, cancelled)


def _at_rest(frames: RobotMotion, stop_window: float) -> Array:
    """Return the pose [7 + J] in which a trajectory through frames comes to rest."""
    qpos = np.concatenate([frames.root_position, frames.root_orientation, frames.joints], axis=1)
    end = len(qpos) - 1.0
    place = end - 0.5 * min(stop_window * frames.fps, end)
    first = min(int(place), len(qpos) - 2)
    return qpos[first] + (place - first) * (qpos[first + 1] - qpos[first])
