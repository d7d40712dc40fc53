"""The parameters of the `sim` node; all are read once, at start."""

from __future__ import annotations

from motiondiffuse_ros.robots import available_robots, robot_refusal
from motiondiffuse_ros.ros.parameter_spec import ParameterSpec

SIM_PARAMETERS: dict[str, ParameterSpec] = {
    "robot": ParameterSpec(
        "humanoid",
        f"robot to simulate: {', '.join(available_robots())}, or a description file",
        check=robot_refusal,
    ),
    "root": ParameterSpec(
        "assisted",
        "floating base: held on its path by an outside force, or left to the joints",
        choices=("assisted", "free"),
    ),
    "real_time_factor": ParameterSpec(1.0, "simulated over real time [1]", (0.05, 20.0)),
    "publish_rate": ParameterSpec(100.0, "of joint_states, odom and /clock [Hz]", (1.0, 1000.0)),
    "approach_seconds": ParameterSpec(
        1.0, "time from the present pose to a trajectory's first point [s]", (0.1, 30.0)
    ),
    "record": ParameterSpec("", "file for the executed motion (npz); empty = none"),
    "window": ParameterSpec(False, "show the simulation in a window"),
}
"""All parameters of the node by name."""
