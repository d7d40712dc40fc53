"""Report and retargeting against real time."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.speed_parts.clock import median_seconds
from benchmarks.speed_parts.sampling import TEXT
from motiondiffuse_ros.physics.report import assess
from motiondiffuse_ros.planner import Planner, PlannerConfig
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import build_trajectory, get_robot
from motiondiffuse_ros.ros.conversions import plan_to_message


def measure_checks(seconds: float, repeats: int, robots: Sequence[str]) -> dict[str, float]:
    """Return how many seconds of motion each part of the checking takes in a second.

    Args:
        seconds: Length of the motion [s].
        repeats: Of each.
        robots: The first one's retargeting is the contract's figure; those whose model is not on
            this machine should be left out.
    """
    from std_msgs.msg import Header

    planner = Planner(PlannerConfig(candidates=1))
    plan = planner.plan(MotionRequest.from_text(TEXT, seconds, seed=0))
    motion = plan.motion

    def factor(work) -> float:
        return seconds / median_seconds(work, repeats)

    figures = {
        "report_realtime_factor": factor(lambda: assess(motion, track=False)),
        "report_with_tracking_realtime_factor": factor(lambda: assess(motion)),
        "messages_realtime_factor": factor(lambda: plan_to_message(plan, Header(), plan_id="")),
    }
    for i, name in enumerate(robots):
        robot = get_robot(name)
        key = "retarget_realtime_factor" if i == 0 else f"retarget_{name}_realtime_factor"
        figures[key] = factor(lambda robot=robot: build_trajectory(robot, motion))
    return figures
