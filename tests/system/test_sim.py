"""The sim node does what is published, shows it on the usual topics, and records it."""

import numpy as np
from nav_msgs.msg import Odometry
from ros_graph import ANSWER, START
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from synthetic import waving
from trajectory_msgs.msg import JointTrajectory, MultiDOFJointTrajectory

from motiondiffuse_ros.robots import build_trajectory, get_robot
from motiondiffuse_ros.robots.simulation import ExecutedMotion
from motiondiffuse_ros.ros.client import MotionClient
from motiondiffuse_ros.ros.conversions import (
    joint_trajectory_to_message,
    root_trajectory_to_message,
)
from motiondiffuse_ros.ros.execution_status import stamp_key
from motiondiffuse_ros.ros.processes import ros_arguments, running
from motiondiffuse_ros.ros.qos import LATCHED

MODULE = "motiondiffuse_ros.ros.sim_node"


class Planner(MotionClient):
    """Publishes trajectories as the `motiondiffuse` node does."""

    def __init__(self, alive) -> None:
        super().__init__(alive)
        self._joints = self.node.create_publisher(
            JointTrajectory, "motiondiffuse/joint_trajectory", LATCHED
        )
        self._root = self.node.create_publisher(
            MultiDOFJointTrajectory, "motiondiffuse/root_trajectory", LATCHED
        )
        self.received: dict[str, list] = {}
        for kind, topic in ((JointState, "joint_states"), (Odometry, "odom"), (Clock, "clock")):
            self.received[topic] = []
            self.node.create_subscription(kind, f"/{topic}", self.received[topic].append, 10)

    def publish(self, trajectory, spoil=lambda message: None) -> str:
        header = Header(stamp=self.node.get_clock().now().to_msg())
        message = joint_trajectory_to_message(trajectory, header)
        spoil(message)
        self._joints.publish(message)
        self._root.publish(root_trajectory_to_message(trajectory, header))
        return stamp_key(header.stamp)


def test_it_follows_a_trajectory_and_refuses_a_broken_one(graph):
    robot = get_robot("humanoid")
    trajectory = build_trajectory(robot, waving(40))
    record, log = graph / "executed.npz", graph / "sim.log"
    arguments = ros_arguments(record=record, real_time_factor=4.0)
    with running(MODULE, arguments, log) as sim, Planner(lambda: sim.poll() is None) as planner:
        planner.wait(lambda: all(planner.received.values()), START, "the robot's state")
        planner.publish(trajectory, lambda message: message.points[3].velocities.pop())
        planner.wait(lambda: "trajectory refused" in log.read_text(), ANSWER, "the refusal")
        stamp = planner.publish(trajectory)
        values = planner.wait_for_execution(stamp, lambda status: None, ANSWER)

    assert values["root"] == "assisted"
    assert values["fallen"] == "False"
    assert float(values["joint_error_rad"]) < 0.1
    executed = ExecutedMotion.load_npz(record)
    assert executed.joint_error < 0.1
    assert abs(len(executed.qpos) / executed.fps - trajectory.duration) < 0.1

    joints, odometry = planner.received["joint_states"], planner.received["odom"]
    assert tuple(joints[-1].name) == robot.joint_names
    wrist = robot.joint_names.index("right_elbow_z")
    assert np.ptp([j.position[wrist] for j in joints]) > 0.5
    assert odometry[-1].child_frame_id == "pelvis"
    clock = [c.clock.sec + c.clock.nanosec * 1e-9 for c in planner.received["clock"]]
    assert (np.diff(clock) >= 0.0).all()
    assert sim.returncode == 0


def test_a_sim_that_cannot_keep_up_still_takes_trajectories(graph):
    trajectory = build_trajectory(get_robot("humanoid"), waving(40))
    # every tick then takes longer than its period
    arguments = ros_arguments(real_time_factor=20.0, publish_rate=1000.0)
    log = graph / "sim.log"
    with running(MODULE, arguments, log) as sim, Planner(lambda: sim.poll() is None) as planner:
        planner.wait(lambda: all(planner.received.values()), START, "the robot's state")
        for _ in range(3):
            stamp = planner.publish(trajectory)
            values = planner.wait_for_execution(stamp, lambda status: None, ANSWER)
            assert values["fallen"] == "False"
