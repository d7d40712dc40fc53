"""A simulated robot's state as the topics that a real one has."""

from __future__ import annotations

from array import array

from geometry_msgs.msg import Point, TransformStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.robots.simulation import SimulatedRobot
from motiondiffuse_ros.ros.conversions.trajectory import (
    quaternion_to_message,
    to_time,
    vector_to_message,
)

try:  # part of every ROS 2 install, but not of the wheels
    from tf2_msgs.msg import TFMessage  # pyright: ignore[reportMissingImports]
except ImportError:
    TFMessage = None

WORLD_FRAME = "odom"


class StatePublisher:
    """Publishes `joint_states`, `odom`, /clock and, where tf2_msgs is installed, /tf."""

    def __init__(self, node: Node, robot: SimulatedRobot) -> None:
        """Create the publishers."""
        self._robot = robot
        self._base = robot.model.body(int(robot.model.jnt_bodyid[0])).name
        self._clock = node.create_publisher(Clock, "/clock", 10)
        self._joints = node.create_publisher(JointState, "joint_states", 10)
        self._odometry = node.create_publisher(Odometry, "odom", 10)
        self._tf = node.create_publisher(TFMessage, "/tf", 100) if TFMessage else None

    def publish(self) -> None:
        """Publish the present state, stamped with simulated time."""
        data = self._robot.data
        stamp = to_time(self._robot.time)
        self._clock.publish(Clock(clock=stamp))
        self._joints.publish(
            JointState(
                header=Header(stamp=stamp),
                name=list(self._robot.robot.joint_names),
                position=array("d", data.qpos[7:]),
                velocity=array("d", data.qvel[6:]),
                effort=array("d", data.qfrc_actuator[6:]),
            )
        )
        self._publish_base(Header(stamp=stamp, frame_id=WORLD_FRAME))

    def _publish_base(self, header: Header) -> None:
        data = self._robot.data
        x, y, z = data.qpos[:3].tolist()
        orientation = quaternion_to_message(data.qpos[3:7])
        odometry = Odometry(header=header, child_frame_id=self._base)
        odometry.pose.pose.position = Point(x=x, y=y, z=z)
        odometry.pose.pose.orientation = orientation
        # an Odometry twist is in the child frame; MuJoCo's angular part already is
        linear = rot.rotate(rot.conjugate(data.qpos[3:7]), data.qvel[:3])
        odometry.twist.twist.linear = vector_to_message(linear)
        odometry.twist.twist.angular = vector_to_message(data.qvel[3:6])
        self._odometry.publish(odometry)
        if self._tf is not None and TFMessage is not None:
            transform = TransformStamped(header=header, child_frame_id=self._base)
            transform.transform.translation = vector_to_message(data.qpos[:3])
            transform.transform.rotation = orientation
            self._tf.publish(TFMessage(transforms=[transform]))
