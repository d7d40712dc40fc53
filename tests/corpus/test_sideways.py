import pytest
from synthetic import moved, standing

from motiondiffuse_ros.corpus.sideways import forms_of, name_side
from motiondiffuse_ros.motion.features import PoseState

STATE = PoseState()


def _gliding(ahead, left):
    motion = standing(41)
    times = (motion.root[:, :1] * 0.0) + [[i / motion.fps] for i in range(motion.frames)]
    return STATE.encode(moved(motion, times * [ahead, left, 0.0]))


@pytest.mark.parametrize(
    ("text", "ahead", "left", "named"),
    [
        ("a person walks sideways", 0.0, 0.5, "a person walks sideways to the left"),
        ("a person walks sideways", 0.0, -0.5, "a person walks sideways to the right"),
        ("a person walks sideways", 0.5, 0.5, "a person walks sideways"),
        ("a person walks sideways", 0.0, 0.05, "a person walks sideways"),
        ("a person sidesteps left", 0.0, -0.5, "a person sidesteps left"),
        ("a person walks", 0.0, 0.5, "a person walks"),
    ],
)
def test_the_side_is_named_only_where_it_is_open_and_certain(text, ahead, left, named):
    got = name_side(text, _gliding(ahead, left), STATE, 20.0)
    assert got == named
    assert got in forms_of(text)
