"""A motion of the canonical skeleton as configurations of a robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.state import hinges_from_motion
from motiondiffuse_ros.robots.embodiment import embodiment
from motiondiffuse_ros.robots.foot_paths import foot_paths
from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.self_collision import overlaps_between

_DENSER = (2, 4)  # times the motion's frames, tried in turn


@dataclass(frozen=True, eq=False)
class RobotMotion:
    """Configurations of a robot, uniformly sampled; limits are not yet applied.

    Attributes:
        root_position: Of the floating base [T, 3], m.
        root_orientation: Of the floating base [T, 4], wxyz, neighbours on one hemisphere.
        joints: Joint positions [T, J], rad, continuous over time.
        fps: Frames per second: those of the motion, or a multiple of them.
    """

    root_position: Array = field(repr=False)
    root_orientation: Array = field(repr=False)
    joints: Array = field(repr=False)
    fps: float


def retarget(
    robot: Robot,
    motion: Motion,
    progress: Callable[[float], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> RobotMotion:
    """Carry a motion over to a robot.

    The humanoid takes it joint by joint. Other robots get the path scaled by the length of their
    legs, feet that stand where they stand, trunk and limbs in the directions of the skeleton's,
    as far as their limits and bodies allow; see docs/robots.md. Where limbs are so fast that they
    would pass through the body between two frames, there are twice or four times as many.

    Args:
        robot: Who moves.
        motion: Finite, at any rate.
        progress: Told the share done, 0 to 1; that of the first attempt where more are needed.
        cancelled: Asked before every frame that takes work.

    Raises:
        RobotError: If this version cannot retarget to such a robot.
        Cancelled: If `cancelled` says so.
    """
    kind = robot.description.retargeting
    if kind == "exact":
        return RobotMotion(
            motion.root,
            rot.continuous(motion.rotations[:, 0]),
            hinges_from_motion(motion),
            motion.fps,
        )
    if kind != "ik":
        raise RobotError(f"robot '{robot.name}': unknown retargeting '{kind}'; known: exact, ik")
    frames = _followed(robot, motion, progress, cancelled)
    for denser in _DENSER:
        if not overlaps_between(robot, frames.joints):
            break
        frames = _followed(robot, motion.resample(denser * motion.fps), None, cancelled)
    return frames


def path_scale(robot: Robot) -> float:
    """Return the length of a robot's way over that of the motion's."""
    return 1.0 if robot.is_canonical else embodiment(robot).scale


def to_joint_positions(robot: Robot, motion: Motion) -> Array:
    """Return the robot's joint positions [T, J], rad, for the frames of a motion."""
    frames = retarget(robot, motion)
    return frames.joints[:: round(frames.fps / motion.fps)]


def _followed(
    robot: Robot,
    motion: Motion,
    progress: Callable[[float], None] | None,
    cancelled: Callable[[], bool] | None,
) -> RobotMotion:
    # mink and all the solvers that it knows take a fifth of a second to load
    from motiondiffuse_ros.robots.inverse_kinematics import InverseKinematics

    feet = foot_paths(motion, embodiment(robot))
    qpos = InverseKinematics(robot).follow(motion, feet, progress, cancelled)
    return RobotMotion(qpos[:, :3], rot.continuous(qpos[:, 3:7]), qpos[:, 7:], motion.fps)
