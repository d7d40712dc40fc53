import pytest
from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.motion import PARTS
from motiondiffuse_ros.request import LIMITS, MotionRequest, Segment
from motiondiffuse_ros.timeline_text import FORM, parse_timeline

WORDS = st.text("abcdefghijklmnop ,.'", min_size=1, max_size=40).filter(lambda t: t.strip(" ,.'"))
TIME = st.integers(0, 4000).map(lambda n: n / 100)


@st.composite
def pieces(draw):
    start = draw(TIME)
    length = draw(st.integers(50, 1000)) / 100
    parts = tuple(draw(st.lists(st.sampled_from(list(PARTS)), unique=True, max_size=3)))
    return draw(WORDS).strip(), start, round(start + length, 2), parts


def _typed(text, start, end, parts):
    return f"{'+'.join(parts)}[{start:g}-{end:g}]{':' if parts else ''} {text}"


@given(st.lists(pieces(), min_size=1, max_size=5))
def test_what_is_typed_is_what_is_read(timeline):
    typed = " | ".join(_typed(*piece) for piece in timeline)
    assert parse_timeline(typed) == timeline


def test_the_example_of_the_issue():
    request = MotionRequest.from_text(
        "[0-4] a person walks forward | [4-7] turns left | right_arm[5-7]: waves", seed=3
    )
    request.validate()
    assert request.segments == (
        Segment("a person walks forward", 0.0, 4.0),
        Segment("turns left", 4.0, 7.0),
        Segment("waves", 5.0, 7.0, ("right_arm",)),
    )
    assert request.total_seconds == 7.0
    assert request.seed == 3


def test_the_length_may_be_longer_than_the_last_piece():
    request = MotionRequest.from_text("[1-2.5 s] a person jumps", 6.0)
    request.validate()
    assert request.total_seconds == 6.0
    with pytest.raises(RequestError, match=r"ends at 2\.5 s, after the motion's 2 s"):
        MotionRequest.from_text("[1-2.5] a person jumps", 2.0).validate()


@pytest.mark.parametrize("text", ["a person walks", "a person walks | and waves", "walk [fast]"])
def test_a_text_without_times_is_one_text(text):
    request = MotionRequest.from_text(text)
    assert request.segments == (Segment(text, 0.0, LIMITS.default_seconds),)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[0-4] a person walks | waves", r"piece 2 of the text, 'waves', is not a timed text"),
        ("[0 to 4] a person walks", "is not a timed text; write: "),
        ("tail[0-4]: wags", "unknown body part 'tail'; the parts are left_arm"),
        ("[0-4] walks |", "piece 2 of the text, '', is not"),
        ("[4-0] a person walks", "segment 1: ends at 0 s, not after its start at 4 s"),
        ("[0-4]", "segment 1: the text is empty"),
    ],
)
def test_what_cannot_be_read_is_refused(text, message):
    with pytest.raises(RequestError, match=message):
        MotionRequest.from_text(text).validate()


def test_the_form_in_messages_is_good_itself():
    MotionRequest.from_text(FORM).validate()
