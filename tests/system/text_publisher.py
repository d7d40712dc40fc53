"""Another program: only rclpy and common messages. Says a sentence, prints what comes."""

import json
import sys
import time

import rclpy
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

rclpy.init()
node = rclpy.create_node("another_program")
received = []
# default quality of service: nothing that was published before
node.create_subscription(JointTrajectory, "/motiondiffuse/joint_trajectory", received.append, 10)
publisher = node.create_publisher(String, "/motiondiffuse/text", 10)
deadline = time.monotonic() + 120.0
while time.monotonic() < deadline and (
    publisher.get_subscription_count() == 0
    or node.count_publishers("/motiondiffuse/joint_trajectory") == 0
):
    rclpy.spin_once(node, timeout_sec=0.1)
publisher.publish(String(data=sys.argv[1]))
while not received and time.monotonic() < deadline:
    rclpy.spin_once(node, timeout_sec=0.1)
(message,) = received[:1]
print(
    json.dumps(
        {
            "names": list(message.joint_names),
            "times": [
                p.time_from_start.sec + p.time_from_start.nanosec * 1e-9 for p in message.points
            ],
            "positions": [list(p.positions) for p in message.points],
            "velocities": [list(p.velocities) for p in message.points],
        }
    )
)
