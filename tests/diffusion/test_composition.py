import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from motiondiffuse_ros.diffusion.composition import STILL_TEXT, TimedText, compose
from motiondiffuse_ros.motion import PARTS
from motiondiffuse_ros.motion.features import PoseState

STATE = PoseState()
BLEND = 10


def _compose(texts, frames, max_frames=64):
    return compose(tuple(texts), frames, STATE, max_frames=max_frames, blend_frames=BLEND)


def _total(windows, frames):
    total = np.zeros((frames, STATE.dim))
    for w in windows:
        total[w.start : w.stop] += w.weight
    return total


@st.composite
def timelines(draw):
    frames = draw(st.integers(12, 300))
    cut = st.integers(0, frames - 1)
    texts = []
    for i in range(draw(st.integers(0, 6))):
        a, b = sorted((draw(cut), draw(cut)))
        parts = tuple(sorted(draw(st.sets(st.sampled_from(list(PARTS)), max_size=3))))
        texts.append(TimedText(f"text {i}", a, max(b, a + 1), parts))
    return texts, frames


@settings(deadline=None, max_examples=60)
@given(timelines())
def test_weights_sum_to_one_everywhere_and_windows_fit(timeline):
    texts, frames = timeline
    windows = _compose(texts, frames)
    np.testing.assert_allclose(_total(windows, frames), 1.0, atol=1e-6)
    for w in windows:
        assert 0 <= w.start < w.stop <= frames
        assert len(w.weight) <= 64
        assert w.weight.min() >= 0.0


def test_windows_hold_no_more_than_their_own_frames():
    texts = [TimedText(f"text {i}", 50 * i, 50 * i + 50, ("head",)) for i in range(20)]
    windows = _compose([TimedText("walk", 0, 1000), *texts], 1000)
    for w in windows:
        whole = w.weight if w.weight.base is None else w.weight.base
        assert whole.nbytes <= 4 * STATE.dim * 64


def test_one_text_is_one_window_of_full_weight():
    (window,) = _compose([TimedText("walk", 0, 60)], 60)
    assert window.text == "walk"
    np.testing.assert_array_equal(window.weight, 1.0)


def test_neighbours_meet_half_way():
    first, second = _compose([TimedText("walk", 0, 30), TimedText("run", 30, 60)], 60)
    assert (first.start, second.stop) == (0, 60)
    assert first.stop - second.start == BLEND
    middle = first.weight[30 - first.start, 0] + first.weight[29 - first.start, 0]
    np.testing.assert_allclose(middle, 1.0)


def test_a_part_owns_its_features_and_the_body_the_rest():
    windows = _compose([TimedText("walk", 0, 60), TimedText("wave", 0, 60, ("right_arm",))], 60)
    weights = {w.text: w.weight for w in windows}
    arm = STATE.part_indices("right_arm")
    np.testing.assert_array_equal(weights["wave"][:, arm], 1.0)
    np.testing.assert_array_equal(weights["walk"][:, arm], 0.0)
    assert weights["wave"].sum() == len(arm) * 60


def test_what_nobody_asks_for_stands_still():
    windows = _compose([TimedText("wave", 20, 40, ("right_arm",))], 60)
    assert {w.text for w in windows} == {"wave", STILL_TEXT}
