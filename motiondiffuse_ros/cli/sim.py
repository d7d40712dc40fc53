"""`motiondiffuse sim`: the simulated robot without colcon or launch."""

from __future__ import annotations

from collections.abc import Sequence

from motiondiffuse_ros.cli.ros_command import run_ros_command
from motiondiffuse_ros.ros.sim_node import main
from motiondiffuse_ros.ros.sim_parameters import SIM_PARAMETERS

USAGE = """usage: motiondiffuse sim [--ros-args ...]

Run the node `sim` until Ctrl-C: a robot in MuJoCo that follows what the node
`motiondiffuse` publishes, and publishes joint_states, odom, /clock and ~/execution."""


def run_sim(arguments: Sequence[str]) -> int:
    """Run the node with the command's arguments; returns the exit code."""
    return run_ros_command(main, USAGE, SIM_PARAMETERS, arguments)
