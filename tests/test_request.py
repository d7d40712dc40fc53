import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.motion import PARTS
from motiondiffuse_ros.request import LIMITS, MotionRequest, Segment

texts = st.text(alphabet="abc xyz", min_size=1, max_size=40).filter(str.strip)


@st.composite
def requests(draw):
    """Any valid request: consecutive segments on the whole body, one on parts."""
    count = draw(st.integers(1, 5))
    lengths = draw(st.lists(st.floats(0.5, 20.0), min_size=count, max_size=count))
    segments, place = [], 0.0
    for length in lengths:
        segments.append(Segment(draw(texts), place, place + length))
        place += length
    parts = tuple(draw(st.sets(st.sampled_from(list(PARTS)), min_size=1)))
    segments.append(Segment(draw(texts), 0.0, place, parts))
    return MotionRequest(
        tuple(segments),
        duration=draw(st.none() | st.just(place)),
        seed=draw(st.none() | st.integers(0, 2**63 - 1)),
        steps=draw(st.none() | st.integers(1, 1000)),
        candidates=draw(st.none() | st.integers(1, 64)),
        guidance_scale=draw(st.none() | st.floats(0.0, 20.0)),
    )


@given(requests())
def test_valid_requests_pass_and_survive_the_file_format(request_):
    request_.validate()
    assert MotionRequest.from_dict(request_.to_dict()) == request_


def _segment(**changes):
    return {"text": "a person walks", "start": 0.0, "end": 4.0, **changes}


@pytest.mark.parametrize(
    ("segments", "settings", "says"),
    [
        ([], {}, "no segments"),
        ([_segment(text="")], {}, "empty"),
        ([_segment(text="  \t ")], {}, "empty"),
        ([_segment(text="?!")], {}, "no words"),
        ([_segment(text="walk " * 100)], {}, "at most 300"),
        ([_segment(text=None)], {}, "empty"),
        ([_segment(start=-1.0)], {}, "start is -1"),
        ([_segment(end=math.nan)], {}, "end is nan"),
        ([_segment(end=math.inf)], {}, "end is inf"),
        ([_segment(start=3.0, end=2.0)], {}, "not after its start"),
        ([_segment(end=0.2)], {}, "at least 0.5"),
        ([_segment(end=601.0)], {}, "longest motion is 600"),
        ([_segment(start="soon")], {}, "must be a number"),
        ([_segment(parts=["tail"])], {}, "left_arm, right_arm, torso, head, legs"),
        ([_segment(parts=["head", "head"])], {}, "named twice"),
        ([_segment(parts="head")], {}, "list of names"),
        ([_segment(speed=2)], {}, "unknown field 'speed'"),
        ([_segment(), _segment(start=2.0, end=6.0)], {}, "overlap by 2 s on the whole body"),
        (
            [_segment(parts=["head"]), _segment(parts=["head", "torso"], start=1.0)],
            {},
            "overlap by 3 s on head",
        ),
        ([_segment()], {"duration": 2.0}, "after the motion's 2 s"),
        ([_segment()], {"duration": -4.0}, "duration must be"),
        ([_segment()], {"seed": -1}, "seed must be"),
        ([_segment()], {"seed": 1.5}, "seed must be"),
        ([_segment()], {"steps": 0}, "steps must be"),
        ([_segment()], {"candidates": 100}, "candidates must be"),
        ([_segment()], {"guidance_scale": math.nan}, "guidance_scale must be"),
        ([_segment()], {"robot": ""}, "robot"),
        ([_segment()], {"colour": "red"}, "unknown field 'colour'"),
        ("walk", {}, "must be a list"),
        (["walk"], {}, "must be a mapping"),
    ],
)
def test_bad_requests_are_refused_in_one_line(segments, settings, says):
    with pytest.raises(RequestError, match=says) as caught:
        MotionRequest.from_dict({"segments": segments, **settings})
    assert "\n" not in str(caught.value)


def test_neighbours_may_overlap_by_the_blend():
    segments = [_segment(), _segment(start=4.0 - LIMITS.blend, end=8.0)]
    assert MotionRequest.from_dict({"segments": segments}).total_seconds == 8.0


def test_parts_may_move_under_a_whole_body_text():
    MotionRequest.from_dict({"segments": [_segment(), _segment(parts=["right_arm"])]})


@pytest.mark.parametrize("content", ["segments: [", "- 1\n- 2", "", "segments: 3"])
def test_broken_request_files_are_refused_by_name(tmp_path, content):
    path = tmp_path / "request.yaml"
    path.write_text(content)
    with pytest.raises(RequestError, match=r"request\.yaml"):
        MotionRequest.from_yaml(path)


def test_missing_request_file_is_refused(tmp_path):
    with pytest.raises(RequestError, match="cannot be read"):
        MotionRequest.from_yaml(tmp_path / "none.yaml")
