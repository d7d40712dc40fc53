"""Requests in pieces: nothing asked for is lost, and every piece is a valid request."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.motion.parts import PARTS
from motiondiffuse_ros.pieces import TAIL, split
from motiondiffuse_ros.request import MotionRequest, Segment
from motiondiffuse_ros.waypoint import Waypoint


@st.composite
def requests(draw) -> MotionRequest:
    segments = []
    for parts in [(), *((part,) for part in PARTS)]:
        time = 0.0
        for i in range(draw(st.integers(0 if parts else 1, 4))):
            start = time + draw(st.floats(0.0, 3.0))
            time = start + draw(st.floats(0.5, 12.0))
            segments.append(Segment(f"text {i}", start, time, parts))
    request = MotionRequest(tuple(segments), seed=draw(st.none() | st.integers(0, 2**63 - 1)))
    request.validate()
    return request


@given(requests(), st.floats(0.1, 20.0))
def test_pieces_are_valid_and_cover_the_request(request, horizon):
    pieces = split(request, horizon)
    for piece in pieces:
        piece.request.validate()
    ends = [piece.start + piece.request.total_seconds for piece in pieces]
    assert pieces[0].start == 0.0
    assert math.isclose(ends[-1], request.total_seconds)
    for end, following in zip(ends, pieces[1:], strict=False):
        assert math.isclose(end, following.start + TAIL)


@given(requests(), st.floats(0.1, 20.0))
def test_every_text_is_in_the_piece_where_it_lasts(request, horizon):
    for piece in split(request, horizon):
        end = piece.start + piece.request.total_seconds
        texts = {(s.text, s.parts) for s in piece.request.segments}
        for segment in request.segments:
            if min(segment.end, end) - max(segment.start, piece.start) >= 0.5 + 1e-9:
                assert (segment.text, segment.parts) in texts


@pytest.mark.parametrize(
    ("horizon", "fields"), [(0.0, {}), (3.0, {"waypoints": (Waypoint(4.0, 1.0, 0.0),)})]
)
def test_some_requests_stay_whole(horizon, fields):
    request = MotionRequest((Segment("a person walks", 0.0, 20.0),), **fields)
    (piece,) = split(request, horizon)
    assert piece.request is request


@pytest.mark.parametrize(("asked", "first"), [(None, 2), (4, 2), (1, 1)])
def test_the_first_of_several_pieces_may_have_fewer_candidates(asked, first):
    request = MotionRequest((Segment("a person walks", 0.0, 20.0),), candidates=asked)
    head, *rest = split(request, 3.0, first_candidates=2)
    assert head.request.candidates == first
    assert {piece.request.candidates for piece in rest} == {asked}
    (whole,) = split(request, 0.0, first_candidates=2)
    assert whole.request is request


def test_pieces_have_seeds_of_their_own():
    request = MotionRequest((Segment("a person walks", 0.0, 12.0),), seed=2**63 - 1)
    assert [piece.request.seed for piece in split(request, 4.0)] == [2**63 - 1, 0, 1]
