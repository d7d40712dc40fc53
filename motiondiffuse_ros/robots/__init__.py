"""Robots, motion made theirs, and trajectories that their controllers can take as they are."""

from motiondiffuse_ros.robots.registry import available_robots, get_robot, robot_refusal
from motiondiffuse_ros.robots.retargeting import path_scale, retarget, to_joint_positions
from motiondiffuse_ros.robots.robot import Robot, RobotDescription
from motiondiffuse_ros.robots.start_state import RootState, StartState
from motiondiffuse_ros.robots.trajectory import JointTrajectory
from motiondiffuse_ros.robots.trajectory_builder import build_trajectory
from motiondiffuse_ros.robots.validation import broken_promises

__all__ = [
    "JointTrajectory",
    "Robot",
    "RobotDescription",
    "RootState",
    "StartState",
    "available_robots",
    "broken_promises",
    "build_trajectory",
    "get_robot",
    "path_scale",
    "retarget",
    "robot_refusal",
    "to_joint_positions",
]
