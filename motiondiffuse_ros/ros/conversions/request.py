"""`MotionRequest`, both ways. The message has no optional fields: its defaults mean "not set"."""

from __future__ import annotations

from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.msg import MotionRequest as MotionRequestMsg
from motiondiffuse_ros.msg import MotionSegment as MotionSegmentMsg
from motiondiffuse_ros.physics.report import TimedText
from motiondiffuse_ros.request import MotionRequest, Segment

DRAWN = -1
"""Seed of a message that leaves the choice to the node."""


def request_from_message(message: MotionRequestMsg, *, robot: str) -> MotionRequest:
    """Read a message; nothing is validated beyond what the dataclass cannot hold.

    Args:
        message: As received.
        robot: Used where the message names none.

    Raises:
        RequestError: If the seed is negative and not -1.
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
