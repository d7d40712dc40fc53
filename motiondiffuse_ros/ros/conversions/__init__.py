"""Between this package's dataclasses and its ROS messages; no logic beyond the change of form."""

from motiondiffuse_ros.ros.conversions.plan import plan_to_message
from motiondiffuse_ros.ros.conversions.report import report_to_message
from motiondiffuse_ros.ros.conversions.request import request_from_message, request_to_message
from motiondiffuse_ros.ros.conversions.trajectory import (
    joint_trajectory_to_message,
    root_trajectory_to_message,
    trajectory_from_messages,
)

__all__ = [
    "joint_trajectory_to_message",
    "plan_to_message",
    "report_to_message",
    "request_from_message",
    "request_to_message",
    "root_trajectory_to_message",
    "trajectory_from_messages",
]
