"""What the commands that run one ROS node have in common."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence

from rclpy.utilities import remove_ros_args

from motiondiffuse_ros.ros.parameter_spec import ParameterSpec


def run_ros_command(
    main: Callable[[Sequence[str]], int],
    usage: str,
    parameters: Mapping[str, ParameterSpec],
    arguments: Sequence[str],
) -> int:
    """Hand the arguments to a node, or explain them.

    Args:
        main: Runs the node.
        usage: First lines of the help.
        parameters: Listed in the help.
        arguments: Of the command; all of them after `--ros-args`.

    Returns:
        Exit code; 2 for arguments that are not ROS's.
    """
    if "-h" in arguments or "--help" in arguments:
        print(usage)
        print("\nparameters (--ros-args -p NAME:=VALUE):")
        for name, spec in parameters.items():
            print(f"  {name:<18}{spec.explain()}")
        return 0
    command = ["motiondiffuse", *arguments]
    if unknown := remove_ros_args(command)[1:]:
        print(f"unknown argument {unknown[0]}; node arguments follow --ros-args", file=sys.stderr)
        return 2
    return main(command)
