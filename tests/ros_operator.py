"""Somebody who steers a node and looks after it."""

from __future__ import annotations

from typing import Any

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import SetParameters
from rclpy.client import Client
from rclpy.parameter import Parameter
from ros_graph import ANSWER, START

from motiondiffuse_ros.ros.client import Alive, MotionClient


class Operator(MotionClient):
    """Somebody who steers the node's lifecycle."""

    def __init__(self, alive: Alive = lambda: True) -> None:
        super().__init__(alive)
        self._services: dict[str, Client] = {}

    def call(self, kind, name: str, request) -> Any:
        if name not in self._services:  # each one that is made stays in the other side's memory
            self._services[name] = self.node.create_client(kind, f"/motiondiffuse/{name}")
        service = self._services[name]
        self.wait(lambda: self.heard and service.service_is_ready(), START, name)
        future = service.call_async(request)
        self.wait(future.done, ANSWER, f"an answer of {name}")
        return future.result()

    def change(self, transition: int) -> bool:
        request = ChangeState.Request(transition=Transition(id=transition))
        return self.call(ChangeState, "change_state", request).success

    def state(self) -> int:
        return self.call(GetState, "get_state", GetState.Request()).current_state.id

    def set(self, name: str, value) -> str:
        """Set a parameter; returns the reason of a refusal, or nothing."""
        parameter = Parameter(name, value=value).to_parameter_msg()
        answer = self.call(
            SetParameters, "set_parameters", SetParameters.Request(parameters=[parameter])
        )
        return "" if answer.results[0].successful else answer.results[0].reason
