import numpy as np
import pytest
from synthetic import moved, standing

from motiondiffuse_ros.corpus.captions import mirror_caption
from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.corpus.statements import (
    Statement,
    all_statements,
    state,
    state_in_reverse,
    statements_of,
)
from motiondiffuse_ros.motion.features import PoseState

STATE = PoseState()
FPS = 20.0


def _statements(features):
    return {s.kind: s.texts for s in state(features, STATE, FPS)}


def _of(paths, name):
    path = next(p for p in paths if p.stem == name)
    return STATE.encode(load_motion(path).resample(FPS))


@pytest.mark.parametrize(
    ("clip", "kind", "word"),
    [
        ("02_01", "walk", "walk"),
        ("09_01", "run", "run"),
        ("dataset-2_run_normal_001", "run", "run"),
        ("dataset-2_raise-up-left-hand_normal_001", "one hand up", "left"),
        ("dataset-2_wave-right-hand_normal_001", "one hand waves", "right"),
        ("dataset-2_walk-turn-right_normal_001", "curve", "right"),
        ("dataset-1_bow_active_001", "bow", "bow"),
    ],
)
def test_real_clips_are_stated_as_what_they_are(real_paths, clip, kind, word):
    features = _of(real_paths, clip)
    texts = _statements(features)[kind]
    assert any(word in text for text in texts)
    other = {"left": "right", "right": "left"}.get(word)
    assert other is None or all(other not in t or word in t for t in texts)


def test_a_walk_in_reverse_is_stated_as_walking_backward(real_paths):
    (walk,) = (s for s in state(_of(real_paths, "02_01"), STATE, FPS) if s.kind == "walk")
    stated = state_in_reverse(walk)
    motion = load_motion(next(p for p in real_paths if p.stem == "02_01")).resample(FPS)
    backward = STATE.encode(motion.reversed())
    assert stated is not None
    assert stated.texts == _statements(backward)["back"]
    run = Statement("run", ("a person runs forward",))
    assert state_in_reverse(run) is None


def test_the_mirror_image_of_a_window_states_the_mirrored_text(real_paths):
    index, sign = STATE.mirror()
    for path in real_paths:
        features = STATE.encode(load_motion(path).resample(FPS))
        mirrored = _statements(features[:, index] * sign)
        expected = {
            kind: tuple(map(mirror_caption, texts)) for kind, texts in _statements(features).items()
        }
        assert mirrored == expected, path


def test_a_body_that_glides_without_stepping_is_not_said_to_walk():
    still = standing(81)
    times = np.arange(still.frames)[:, None] / still.fps
    assert not _statements(STATE.encode(moved(still, times * [1.0, 0.0, 0.0])))


def test_a_body_at_rest_is_said_to_stand_still():
    assert set(_statements(STATE.encode(standing(81)))) == {"still"}


def test_every_sentence_can_be_given_and_every_given_one_is_known(real_paths):
    sentences = set(all_statements())
    assert {mirror_caption(text) for text in sentences} == sentences
    for path in real_paths:
        for texts in _statements(STATE.encode(load_motion(path).resample(FPS))).values():
            assert set(texts) <= sentences


def test_a_sentence_is_also_said_of_others_and_to_somebody():
    texts = statements_of(("back",))
    assert texts == ("a person walks backward", "a person steps back")
    assert {"a woman walks backward", "walk backward", "step back"} <= set(all_statements())
    assert "raise both hands and wave with them" in all_statements()
    assert "hold your left hand above your head" in all_statements()
