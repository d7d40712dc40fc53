"""The topics that carry a plan."""

from __future__ import annotations

from uuid import uuid4

from rclpy.lifecycle import LifecycleNode
from rclpy.time import Time
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, MultiDOFJointTrajectory

from motiondiffuse_ros.msg import MotionPlan
from motiondiffuse_ros.planner import Plan
from motiondiffuse_ros.ros.conversions import plan_to_message
from motiondiffuse_ros.ros.qos import LATCHED
from motiondiffuse_ros.ros.reference import ReferenceStream


class PlanPublisher:
    """Publishes `~/plan` and its two trajectories, and starts `~/reference`."""

    def __init__(self, node: LifecycleNode, frame_id: str, rate: float) -> None:
        """Create the publishers, inactive until the node is active.

        Args:
            node: Owner.
            frame_id: Frame in which the root moves.
            rate: Of `~/reference` [Hz].
        """
        self._node = node
        self._frame_id = frame_id
        self._plan = node.create_lifecycle_publisher(MotionPlan, "~/plan", LATCHED)
        self._joints = node.create_lifecycle_publisher(
            JointTrajectory, "~/joint_trajectory", LATCHED
        )
        self._root = node.create_lifecycle_publisher(
            MultiDOFJointTrajectory, "~/root_trajectory", LATCHED
        )
        self.reference = ReferenceStream(node, rate)

    def publish(self, plan: Plan, at: Time | None = None) -> MotionPlan:
        """Publish a plan on all topics; its three messages share one header.

        Args:
            plan: What to publish.
            at: When its first point is due, and its stamp; until then `~/reference` goes on with
                the plan before. None = now.
        """
        stamp = at or self._node.get_clock().now()
        self.reference.start(plan.trajectory, stamp)  # it does not wait for the messages
        header = Header(stamp=stamp.to_msg(), frame_id=self._frame_id)  # shared by all three
        message = plan_to_message(plan, header, plan_id=str(uuid4()))
        self._root.publish(message.root_trajectory)
        self._joints.publish(message.trajectory)
        self._plan.publish(message)
        return message

    def destroy(self) -> None:
        """Remove everything from the node."""
        self.reference.destroy()
        for publisher in (self._plan, self._joints, self._root):
            self._node.destroy_lifecycle_publisher(publisher)
