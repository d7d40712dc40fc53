"""A plan as `MotionPlan`."""

from __future__ import annotations

from std_msgs.msg import Header

from motiondiffuse_ros.msg import MotionPlan
from motiondiffuse_ros.planner import Plan
from motiondiffuse_ros.ros.conversions.report import report_to_message
from motiondiffuse_ros.ros.conversions.request import request_to_message
from motiondiffuse_ros.ros.conversions.trajectory import (
    joint_trajectory_to_message,
    root_trajectory_to_message,
)


def plan_to_message(plan: Plan, header: Header, plan_id: str) -> MotionPlan:
    """Write a plan with its trajectories, report and timings."""
    timings = {f"{stage}_time": float(seconds) for stage, seconds in plan.timings_s.items()}
    fields = MotionPlan.get_fields_and_field_types()
    return MotionPlan(
        header=header,
        plan_id=plan_id,
        request=request_to_message(plan.request),
        seed=plan.seed,
        weights_sha256=plan.weights_sha256,
        robot=plan.robot,
        trajectory=joint_trajectory_to_message(plan.trajectory, header),
        root_trajectory=root_trajectory_to_message(plan.trajectory, header),
        report=report_to_message(plan.report),
        duration=float(plan.trajectory.times[-1]),
        **{name: seconds for name, seconds in timings.items() if name in fields},
    )
