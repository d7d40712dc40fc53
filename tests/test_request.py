import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.edit import Edit, parse_spans
from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.motion import PARTS
from motiondiffuse_ros.request import LIMITS, MotionRequest, Segment
from motiondiffuse_ros.waypoint import Waypoint

texts = st.text(alphabet="abc xyz", min_size=1, max_size=40).filter(str.strip)


EXTRAS = (
    {},
    {"waypoints": (Waypoint(0.25, 0.5, 0.0), Waypoint(0.5, 0.5, -0.25, 1.5))},
    {"edit": Edit("motion.npz", ("left_arm", "head"))},
    {"edit": Edit("walk.bvh", keep=((0.0, 0.25), (0.25, 0.5)))},
)


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
        **draw(st.sampled_from(EXTRAS)),
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


def _waypoint(**changes):
    return {"time": 2.0, "x": 1.0, "y": 0.5, **changes}


@pytest.mark.parametrize(
    ("waypoints", "says"),
    [
        (3, "'waypoints' must be a list"),
        (["there"], "must be a mapping with the fields time, x, y, heading"),
        ([_waypoint(z=1.0)], "waypoint 1: unknown field 'z'; they are time, x, y, heading"),
        ([{"time": 1.0, "x": 1.0}], "waypoint 1: y missing"),
        ([_waypoint(x=None)], "waypoint 1: x missing"),
        ([_waypoint(y="left")], "waypoint 1: y must be a number"),
        ([_waypoint(x=math.nan)], "waypoint 1: x is nan m"),
        ([_waypoint(heading=math.inf)], "waypoint 1: heading is inf rad"),
        ([_waypoint(time=math.nan)], "waypoint 1: time is nan s"),
        ([_waypoint(time=0.0)], "not within the motion, which lasts 4 s"),
        ([_waypoint(time=4.5)], "not within the motion, which lasts 4 s"),
        ([_waypoint(), _waypoint()], "waypoint 2: at 2 s, at least 0.2 s after waypoint 1 at 2 s"),
        ([_waypoint(time=0.1, x=0.0)], "at least 0.2 s after the start"),
        ([_waypoint(), _waypoint(time=3.0, x=6.0)], "waypoint 2: needs 5.0 m/s .* at most 4 m/s"),
        ([_waypoint(x=40.0)], "waypoint 1: needs 20.0 m/s"),
    ],
)
def test_waypoints_that_nobody_can_pass_are_refused_in_one_line(waypoints, says):
    with pytest.raises(RequestError, match=says) as caught:
        MotionRequest.from_dict({"segments": [_segment()], "waypoints": waypoints})
    assert "\n" not in str(caught.value)


def _edit(**changes):
    return {"motion": "motion.npz", "regenerate": ["head"], **changes}


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        ("motion.npz", "edit: must be a mapping with the fields motion, regenerate, keep"),
        ({"regenerate": ["head"]}, "'motion' must be the name of a file"),
        (_edit(motion=""), "no file"),
        (_edit(parts=["head"]), "unknown field 'parts'"),
        (_edit(regenerate=[]), "keeps nothing"),
        (_edit(regenerate="head"), "must be a list of names"),
        (_edit(regenerate=["tail"]), "left_arm, right_arm, torso, head, legs"),
        (_edit(regenerate=["head", "head"]), "named twice"),
        (_edit(keep=1.0), "must be a list"),
        (_edit(keep=[1.0]), "span 1 of 'keep' must be \\[start, end\\]"),
        (_edit(keep=[["a", "b"]]), "must be a number"),
        (_edit(keep=[[0.0, math.nan]]), "must be finite"),
        (_edit(keep=[[2.0, 1.0]]), "end after its start"),
        (_edit(keep=[[2.0, 5.0]]), "after the motion's 4 s"),
        (_edit(keep=[[1.0, 3.0], [2.0, 4.0]]), "span 2 to keep starts at 2 s, before the end"),
    ],
)
def test_edits_that_make_no_sense_are_refused_in_one_line(edit, says):
    with pytest.raises(RequestError, match=says) as caught:
        MotionRequest.from_dict({"segments": [_segment()], "edit": edit})
    assert "\n" not in str(caught.value)


def test_an_edited_motion_has_its_own_path():
    with pytest.raises(RequestError, match="leave out waypoints"):
        MotionRequest.from_dict(
            {"segments": [_segment()], "edit": _edit(), "waypoints": [_waypoint()]}
        )


def test_spans_are_read_as_people_type_them():
    assert parse_spans("0-1.5, 4-6") == ((0.0, 1.5), (4.0, 6.0))
    for text in ("", "1", "a-b", "1-2-3", "1-2,"):
        with pytest.raises(RequestError, match=r"write: 0-1\.5,4-6"):
            parse_spans(text)


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
