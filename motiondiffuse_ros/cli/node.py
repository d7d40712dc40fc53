"""`motiondiffuse node`: the planning node without colcon or launch."""

from __future__ import annotations

from collections.abc import Sequence

from motiondiffuse_ros.cli.ros_command import run_ros_command
from motiondiffuse_ros.ros.node import main
from motiondiffuse_ros.ros.parameters import PLANNER_PARAMETERS

USAGE = """usage: motiondiffuse node [--ros-args ...]

Run the lifecycle node `motiondiffuse` until Ctrl-C. It takes text on ~/text
(std_msgs/String), requests on ~/request and goals on the action ~/generate_motion, and
publishes ~/plan, ~/joint_trajectory, ~/root_trajectory and ~/reference."""


def node_main(arguments: Sequence[str]) -> int:
    """Run the node with the command's arguments; returns the exit code."""
    return run_ros_command(main, USAGE, PLANNER_PARAMETERS, arguments)
