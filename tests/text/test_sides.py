import pytest
from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.text.sides import with_side


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("walk in a circle", "walk in a circle to the left"),
        ("A person walks in a circle.", "A person walks in a circle to the left."),
        ("jog around in circles", "jog around in circles to the left"),
        ("walk in a big loop and wave", "walk in a big loop to the left and wave"),
        ("go round and round", "go round and round to the left"),
        ("make a circle", "make a circle to the left"),
        ("he is circling around", "he is circling around to the left"),
        ("follow a circular path, walking", "follow a circular path to the left, walking"),
        ("walk in a circle then turn right", "walk in a circle to the left then turn right"),
        (
            "turn right; run in circles; then walk in a circle",
            "turn right; run in circles to the left; then walk in a circle to the left",
        ),
    ],
)
def test_a_circle_that_is_walked_gets_a_side(typed, told):
    assert with_side(typed) == told


@pytest.mark.parametrize(
    "text",
    [
        "walk in a circle to the right",
        "walk in a circle, turning left",
        "walks counterclockwise in a circle",
        "walk in a right-hand circle",
        "draw circles with the hand",
        "make a circle with your arm",
        "move your arms in circles",
        "make arm circles",
        "walk around",
        "wear a ring",
        "turn around",
        "",
    ],
)
def test_what_has_a_side_or_is_no_way_stays(text):
    assert with_side(text) == text


@given(st.text())
def test_whatever_is_typed_is_only_added_to_and_only_once(text):
    told = with_side(text)
    assert told.replace(" to the left", "") == text.replace(" to the left", "")
    assert with_side(told) == told
