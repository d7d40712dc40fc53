"""A long request in pieces that are planned one after another, each going on from the last.

A robot can begin with the first piece while the others are still being sampled (receding horizon).
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace

from motiondiffuse_ros.diffusion.composition import STILL_TEXT
from motiondiffuse_ros.request import LIMITS, MotionRequest, Segment

TAIL = 1.0
"""Time for which a piece goes on after the next one takes over: if that is late, the robot comes to
rest there [s]."""

SHORTEST = 2.0
"""Least time from one take-over to the next [s]."""


@dataclass(frozen=True)
class Piece:
    """A part of a request.

    Attributes:
        request: What to plan; its times are from the start of the piece.
        start: Of the piece in the whole request, s.
    """

    request: MotionRequest
    start: float


def split(
    request: MotionRequest, horizon: float, first_candidates: int | None = None
) -> tuple[Piece, ...]:
    """Return the pieces of a request, each of which takes over from the one before.

    Waypoints and edits count for the motion as a whole; such a request stays in one piece.

    Args:
        request: Valid.
        horizon: Time from one take-over to the next [s]; 0 leaves the request whole.
        first_candidates: Most candidates of the first of several pieces; None leaves them as they
            are.
    """
    total = request.total_seconds
    if horizon <= 0.0 or request.waypoints or request.edit is not None:
        return (Piece(request, 0.0),)
    horizon = max(horizon, SHORTEST)
    starts = [0.0]
    while total - starts[-1] > horizon + TAIL + LIMITS.min_seconds:
        starts.append(len(starts) * horizon)
    ends = [start + TAIL for start in starts[1:]] + [total]
    pieces = [
        Piece(_cut(request, i, start, end), start)
        for i, (start, end) in enumerate(zip(starts, ends, strict=True))
    ]
    if first_candidates is not None and len(pieces) > 1:
        count = min(first_candidates, request.candidates or first_candidates)
        pieces[0] = Piece(replace(pieces[0].request, candidates=count), 0.0)
    return tuple(pieces)


def nth_seed(seed: int, index: int) -> int:
    """Return the seed of a piece from that of the first one."""
    return (seed + index) % 2**63


def _cut(request: MotionRequest, index: int, start: float, end: float) -> MotionRequest:
    segments = _between(request.segments, start, end)
    if not segments:  # nobody is asked for anything here
        segments = (Segment(STILL_TEXT, 0.0, end - start),)
    seed = None if request.seed is None else nth_seed(request.seed, index)
    return replace(request, segments=segments, duration=end - start, seed=seed)


def _between(segments: tuple[Segment, ...], start: float, end: float) -> tuple[Segment, ...]:
    """Return segments in a span of time; a rest too short for a text goes to its successor."""
    tracks: dict[tuple[str, ...], list[Segment]] = defaultdict(list)
    for segment in sorted(segments, key=lambda s: s.start):
        begins, ends = max(segment.start, start) - start, min(segment.end, end) - start
        if ends - begins >= LIMITS.min_seconds:
            track = tracks[segment.parts]
            if not track and begins < LIMITS.min_seconds:
                begins = 0.0
            track.append(replace(segment, start=begins, end=ends))
    return tuple(segment for track in tracks.values() for segment in track)
