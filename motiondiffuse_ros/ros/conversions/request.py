"""`MotionRequest`, both ways. The message has no optional fields: its defaults mean "not set"."""

from __future__ import annotations

import math

from motiondiffuse_ros.edit import Edit
from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.msg import MotionEdit as MotionEditMsg
from motiondiffuse_ros.msg import MotionRequest as MotionRequestMsg
from motiondiffuse_ros.msg import MotionSegment as MotionSegmentMsg
from motiondiffuse_ros.msg import Waypoint as WaypointMsg
from motiondiffuse_ros.physics.report import TimedText
from motiondiffuse_ros.request import MotionRequest, Segment
from motiondiffuse_ros.waypoint import Waypoint

DRAWN = -1
"""Seed of a message that leaves the choice to the node."""


def request_from_message(message: MotionRequestMsg, *, robot: str) -> MotionRequest:
    """Read a message; nothing is validated beyond what the dataclass cannot hold.

    Args:
        message: As received.
        robot: Used where the message names none.

    Raises:
        RequestError: If the seed is negative and not -1, or spans of an edit lack an end.
    """
    if message.seed < DRAWN:
        raise RequestError(f"seed is {message.seed}; it is 0 or more, or {DRAWN} to draw one")
    return MotionRequest(
        segments=tuple(_segment_from_message(segment) for segment in message.segments),
        duration=message.duration if message.duration != 0.0 else None,
        seed=message.seed if message.seed != DRAWN else None,
        guidance_scale=message.guidance_scale if message.guidance_scale != 0.0 else None,
        steps=message.steps or None,
        candidates=message.candidates or None,
        robot=message.robot or robot,
        waypoints=tuple(_waypoint_from_message(waypoint) for waypoint in message.waypoints),
        edit=_edit_from_message(message.edit),
    )


def request_to_message(request: MotionRequest) -> MotionRequestMsg:
    """Write a request; fields that are None take the message's "not set"."""
    return MotionRequestMsg(
        segments=[segment_to_message(segment) for segment in request.segments],
        duration=float(request.duration or 0.0),
        seed=DRAWN if request.seed is None else int(request.seed),
        guidance_scale=float(request.guidance_scale or 0.0),
        steps=int(request.steps or 0),
        candidates=int(request.candidates or 0),
        robot=request.robot,
        waypoints=[_waypoint_to_message(waypoint) for waypoint in request.waypoints],
        edit=_edit_to_message(request.edit),
    )


def segment_to_message(segment: TimedText) -> MotionSegmentMsg:
    """Write one segment."""
    return MotionSegmentMsg(
        text=segment.text,
        start=float(segment.start),
        end=float(segment.end),
        parts=list(segment.parts),
    )


def _segment_from_message(message: MotionSegmentMsg) -> Segment:
    return Segment(message.text, message.start, message.end, tuple(message.parts))


def _waypoint_to_message(waypoint: Waypoint) -> WaypointMsg:
    return WaypointMsg(
        time=float(waypoint.time),
        x=float(waypoint.x),
        y=float(waypoint.y),
        heading=math.nan if waypoint.heading is None else float(waypoint.heading),
    )


def _waypoint_from_message(message: WaypointMsg) -> Waypoint:
    heading = None if math.isnan(message.heading) else message.heading
    return Waypoint(message.time, message.x, message.y, heading)


def _edit_to_message(edit: Edit | None) -> MotionEditMsg:
    if edit is None:
        return MotionEditMsg()
    return MotionEditMsg(
        file=edit.motion,
        regenerate=list(edit.regenerate),
        keep_start=[float(start) for start, _ in edit.keep],
        keep_end=[float(end) for _, end in edit.keep],
    )


def _edit_from_message(message: MotionEditMsg) -> Edit | None:
    if len(message.keep_start) != len(message.keep_end):
        raise RequestError(
            f"edit: {len(message.keep_start)} starts of spans to keep and "
            f"{len(message.keep_end)} ends; every span needs both"
        )
    if not (message.file or message.regenerate or message.keep_start):
        return None
    spans = zip(message.keep_start, message.keep_end, strict=True)
    return Edit(message.file, tuple(message.regenerate), tuple(spans))
