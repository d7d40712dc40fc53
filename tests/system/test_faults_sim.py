"""A simulation that diverges: it says so, puts the robot back and follows the next trajectory."""

from dataclasses import replace

import numpy as np
from ros_graph import ANSWER, START
from synthetic import waving
from system.test_sim import MODULE, Planner

from motiondiffuse_ros.robots import build_trajectory, get_robot
from motiondiffuse_ros.ros.processes import ros_arguments, running


def test_a_trajectory_that_no_simulation_can_follow(graph):
    good = build_trajectory(get_robot("humanoid"), waving(20))
    # velocities of a hundred million metres a second
    path = good.root_position + np.linspace(0.0, 1e8, len(good.times))[:, None]
    wild = replace(good, root_position=path, positions=1e6 * good.positions)
    log = graph / "sim.log"
    arguments = ros_arguments(real_time_factor=4.0)
    with running(MODULE, arguments, log) as sim, Planner(lambda: sim.poll() is None) as planner:
        planner.wait(lambda: all(planner.received.values()), START, "the robot's state")
        planner.publish(wild)
        planner.wait(lambda: "simulation diverged" in log.read_text(), ANSWER, "the error")
        values = planner.wait_for_execution(planner.publish(good), lambda status: None, ANSWER)
        assert values["fallen"] == "False"
        assert float(values["joint_error_rad"]) < 0.1
    assert "Traceback" not in log.read_text()
