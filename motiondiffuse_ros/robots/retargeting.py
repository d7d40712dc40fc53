"""A motion of the canonical skeleton as configurations of a robot."""

from __future__ import annotations

from dataclasses import dataclass, field

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.state import hinges_from_motion
from motiondiffuse_ros.robots.robot import Robot


@dataclass(frozen=True, eq=False)
class RobotMotion:
    """Configurations of a robot, uniformly sampled; limits are not yet applied.

    Attributes:
        root_position: Of the floating base [T, 3], m.
        root_orientation: Of the floating base [T, 4], wxyz, neighbours on one hemisphere.
        joints: Joint positions [T, J], rad, continuous over time.
        fps: Frames per second.
    """

    root_position: Array = field(repr=False)
    root_orientation: Array = field(repr=False)
    joints: Array = field(repr=False)
    fps: float


def retarget(robot: Robot, motion: Motion) -> RobotMotion:
    """Carry a motion over to a robot, frame by frame.

    Raises:
        RobotError: If this version cannot retarget to such a robot.
    """
    if robot.description.retargeting != "exact":
        kind = robot.description.retargeting
        raise RobotError(f"robot '{robot.name}': unknown retargeting '{kind}'; known are exact")
    return RobotMotion(
        motion.root, rot.continuous(motion.rotations[:, 0]), hinges_from_motion(motion), motion.fps
    )


def to_joint_positions(robot: Robot, motion: Motion) -> Array:
    """Return the robot's joint positions [T, J], rad, for the frames of a motion."""
    return retarget(robot, motion).joints
