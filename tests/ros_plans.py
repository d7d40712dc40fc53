"""Goals as tests send them, and the plans that come back."""

from __future__ import annotations

from motiondiffuse_ros.msg import MotionPlan, MotionRequest, MotionSegment
from motiondiffuse_ros.robots import broken_promises, get_robot
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState
from motiondiffuse_ros.ros.client import Feedback
from motiondiffuse_ros.ros.conversions import trajectory_from_messages


def goal(text: str, seconds: float, **fields) -> MotionRequest:
    """Return a request of one text."""
    return MotionRequest(segments=[MotionSegment(text=text, start=0.0, end=seconds)], **fields)


def ignore(feedback: Feedback) -> None:
    """Take feedback that nobody looks at."""


def seconds(stamp) -> float:
    """Return the time of a stamp [s]."""
    return stamp.sec + 1e-9 * stamp.nanosec


def states(plan: MotionPlan) -> tuple[TrajectoryState, float]:
    """Return a plan's trajectory, its promises checked, and when it begins [s]."""
    trajectory = trajectory_from_messages(plan.trajectory, plan.root_trajectory)
    assert broken_promises(trajectory, get_robot("humanoid")) == ()
    return TrajectoryState(trajectory), seconds(plan.header.stamp)
