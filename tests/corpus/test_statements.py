from dataclasses import replace

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
from motiondiffuse_ros.motion.skeleton import CANONICAL

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


def test_a_slow_walk_in_reverse_is_stated_as_walking_backward_slowly(real_paths):
    motion = load_motion(next(p for p in real_paths if p.stem == "02_01"))
    at_half_speed = replace(motion.resample(2.0 * FPS), fps=FPS)
    (walk,) = (s for s in state(STATE.encode(at_half_speed), STATE, FPS) if s.kind == "slow walk")
    stated = state_in_reverse(walk)
    backward = _statements(STATE.encode(at_half_speed.reversed()))
    assert stated is not None
    assert stated.texts == backward["slow back"]
    assert "back" in backward
    ahead = _statements(_of(real_paths, "02_01"))
    assert not {"slow walk", "slow back"} & set(ahead)


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


def _placed(features, joint, x=None, y=None, z=None):
    """Put a joint somewhere in the heading frame: x left, y up, z ahead."""
    first = STATE.groups()["positions"].start + 3 * (CANONICAL.index(joint) - 1)
    for axis, values in enumerate((x, y, z)):
        if values is not None:
            features[:, first + axis] = values


def _claps(height):
    features = STATE.encode(standing(81))
    apart = 0.25 + 0.2 * np.cos(2 * np.pi * np.arange(81) / 20)
    for side, sign in (("left", 1), ("right", -1)):
        _placed(features, f"{side}_wrist", x=0.5 * sign * apart, y=height, z=0.3)
    return features


def test_hands_that_meet_before_the_chest_again_and_again_clap():
    assert "claps" in _statements(_claps(1.2))
    assert "claps" not in _statements(_claps(1.9))


@pytest.mark.parametrize(("ahead", "kind"), [(0.3, "sit down"), (0.0, "down low")])
def test_what_rests_behind_its_heels_sits_and_what_is_over_them_crouches(ahead, kind):
    features = STATE.encode(standing(81))
    features[20:, STATE.groups()["root_height"]] = 0.5
    for side in ("left", "right"):
        _placed(features[20:], f"{side}_knee", y=0.45)
        _placed(features[20:], f"{side}_ankle", z=ahead)
    assert {"sit down", "down low"} & set(_statements(features)) == {kind}


def _slow_walk(real_paths):
    motion = load_motion(next(p for p in real_paths if p.stem == "02_01")).resample(2 * FPS)
    return STATE.encode(replace(motion, fps=FPS))


def test_a_slow_walk_with_the_heels_up_is_on_tiptoe(real_paths):
    features = _slow_walk(real_paths)
    assert "tiptoe" not in _statements(features)
    for side in ("left", "right"):
        first = STATE.groups()["positions"].start
        toe = features[:, first + 3 * (CANONICAL.index(f"{side}_foot") - 1) + 1]
        _placed(features, f"{side}_ankle", y=toe + 0.15)
    assert "tiptoe" in _statements(features)


def test_a_walk_with_the_knees_as_high_as_the_hips_is_a_march(real_paths):
    features = _slow_walk(real_paths)
    assert "march ahead" not in _statements(features)
    frames = np.arange(len(features))
    for side, phase in (("left", 0), ("right", 10)):
        lifted = (frames + phase) % 20 < 6
        rows = features[lifted]
        _placed(rows, f"{side}_knee", y=0.85)
        features[lifted] = rows
    assert "march ahead" in _statements(features)


def test_knees_that_come_up_to_the_hips_together_do_not_march():
    features = STATE.encode(standing(81))
    low = np.arange(81) % 20 < 6
    for side in ("left", "right"):
        rows = features[low]
        _placed(rows, f"{side}_knee", y=0.85)
        features[low] = rows
        _placed(features, f"{side}_ankle", y=np.where(low, 0.3, 0.08))
    assert not {"march", "march ahead"} & set(_statements(features))


def test_a_few_steps_are_counted_in_words(real_paths):
    features = _slow_walk(real_paths)
    feet = features[:, STATE.groups()["contacts"]].reshape(len(features), 2, -1)
    down = np.diff((feet > 0.5).any(axis=2).astype(int), axis=0) > 0
    (landings,) = np.nonzero(down.any(axis=1))
    assert len(landings) > 4
    for steps, word in ((2, "two"), (3, "three"), (4, "four")):
        window = features[: landings[steps - 1] + 2]
        assert f"a person goes {word} steps ahead" in _statements(window)["steps"]
    assert "steps" not in _statements(features[: landings[0] + 2])


def test_both_hands_on_one_stick_swing_it():
    features = STATE.encode(standing(81))
    place = 0.5 * np.sin(np.clip(np.arange(81) - 40, -4, 4) * np.pi / 8)
    for side, grip in (("left", 0.1), ("right", -0.1)):
        _placed(features, f"{side}_wrist", x=place + grip, y=1.0, z=0.5)
    assert "two-handed swing" in _statements(features)
    _placed(features, "right_wrist", x=-0.6)
    assert "two-handed swing" not in _statements(features)


def _bounces(wrist, spread):
    """Jumps once a second, with wrists and ankles that go out and back on the way."""
    features = STATE.encode(standing(81))
    times = np.arange(81) / FPS % 1.0
    flight = np.maximum(2.5 * times - 4.9 * times**2, 0.0)
    features[:, STATE.groups()["root_height"]] += flight[:, None]
    out = np.arange(81) // 20 % 2 == 1
    for side, sign in (("left", 1), ("right", -1)):
        _placed(features, f"{side}_foot", y=0.02 + flight)
        _placed(features, f"{side}_ankle", x=sign * np.where(out, spread, 0.1))
        _placed(features, f"{side}_wrist", y=np.where(out, wrist, 0.9))
    return features


def test_jumps_with_arms_and_legs_out_and_in_again_are_jumping_jacks():
    assert {"jumps", "jumping jacks"} <= set(_statements(_bounces(2.0, 0.4)))
    few = np.concatenate([_bounces(2.0, 0.4), STATE.encode(standing(81))])
    for other in (_bounces(0.9, 0.4), _bounces(2.0, 0.1), few):
        stated = set(_statements(other))
        assert "jumps" in stated
        assert "jumping jacks" not in stated
