"""Plans as recordings, with the messages in which they are published."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rclpy.serialization import serialize_message
from std_msgs.msg import Header

from motiondiffuse_ros.errors import RecordingNotWritten
from motiondiffuse_ros.msg import MotionPlan
from motiondiffuse_ros.planner import Plan, Planner
from motiondiffuse_ros.recording import Topic, record_of, write_recording
from motiondiffuse_ros.ros.conversions import plan_to_message
from motiondiffuse_ros.ros.diagnostics import Diagnostics
from motiondiffuse_ros.ros.type_definition import type_definition, type_name

NAMESPACE = "/motiondiffuse"
"""Of topics recorded without a node."""


def topics_of(message: MotionPlan, namespace: str) -> list[Topic]:
    """Return a plan's messages on the topics of a node.

    Args:
        message: The plan, as published.
        namespace: Fully qualified name of the node.
    """
    messages: dict[str, Any] = {
        "plan": message,
        "joint_trajectory": message.trajectory,
        "root_trajectory": message.root_trajectory,
    }
    return [
        Topic(
            name=f"{namespace}/{name}",
            type=type_name(type(content)),
            schema=type_definition(type(content)),
            message=serialize_message(content),
        )
        for name, content in messages.items()
    ]


def record_plan(
    path: Path, planner: Planner, plan: Plan, message: MotionPlan, namespace: str = NAMESPACE
) -> None:
    """Write a plan that was just made, stamped as its message is.

    Raises:
        RecordingNotWritten: If it cannot be written, or the motion that was edited is gone.
    """
    try:
        record = record_of(planner, plan)
    except OSError as error:
        raise RecordingNotWritten(
            f"recording {path}: {plan.request.edit} cannot be read again ({error.strerror})"
        ) from error
    stamp = message.header.stamp
    time = stamp.sec * 10**9 + stamp.nanosec
    write_recording(path, record, topics_of(message, namespace), time)


def record_without_node(path: Path, planner: Planner, plan: Plan, plan_id: str, time: int) -> None:
    """Write a plan as a node of no namespace would have published it at a time [ns].

    Raises:
        RecordingNotWritten: As `record_plan`.
    """
    header = Header(frame_id="map")
    header.stamp.sec, header.stamp.nanosec = divmod(time, 10**9)
    record_plan(path, planner, plan, plan_to_message(plan, header, plan_id))


class PlanRecorder:
    """Records plans in a folder; what goes wrong is said, and hinders nothing."""

    def __init__(self, health: Diagnostics, logger: Any, namespace: str) -> None:
        """Take where problems are reported, and the fully qualified name of the node."""
        self._health, self._logger, self._namespace = health, logger, namespace

    def record(self, folder: str, planner: Planner, plan: Plan, message: MotionPlan) -> None:
        """Write STAMP_ID.mcap, the stamp in seconds; an empty folder is none.

        What pieces are together, which has stamp and id of the first, is in STAMP_ID_whole.mcap.
        """
        if not folder:
            self._health.keep("recording", "")
            return
        stamp = message.header.stamp
        ending = "_whole.mcap" if plan.origin.pieces else ".mcap"
        name = f"{stamp.sec}.{stamp.nanosec:09d}_{message.plan_id}{ending}"
        path = Path(folder).expanduser() / name
        problem = ""
        try:
            record_plan(path, planner, plan, message, self._namespace)
        except RecordingNotWritten as error:
            problem = str(error)
            self._logger.warning(problem)
        except Exception as error:  # the plan is published and has to be answered for
            problem = f"recording {path}: {type(error).__name__}: {error}"
            self._logger.error(problem)
        self._health.keep("recording", problem)
