"""A client that sends a long goal, says so once the node works on it, and waits to be killed."""

from motiondiffuse_ros.msg import MotionRequest, MotionSegment
from motiondiffuse_ros.ros.client import Feedback, MotionClient


def say(feedback: Feedback) -> None:
    print(feedback.stage, flush=True)


with MotionClient() as client:
    client.wait_for_node(120.0)
    goal = MotionRequest(
        segments=[MotionSegment(text="a person walks", start=0.0, end=1.0)], steps=300
    )
    client.result(client.send(goal, say, 120.0), 600.0)
