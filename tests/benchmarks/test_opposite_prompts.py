import pytest

from benchmarks.opposite_prompts import PAIRS, judge
from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.evaluation.evaluator import Evaluator, shipped_evaluator

SIDED = [pair for pair in PAIRS if pair.kind == "left or right"]


def _clip(paths, name):
    return load_motion(next(p for p in paths if p.stem == name)).canonicalised()


def _pair(text):
    return next(pair for pair in PAIRS if pair.one == text)


def test_there_are_enough_pairs_and_none_is_a_text_of_the_training_data(training_texts):
    texts = [text for pair in PAIRS for text in (pair.one, pair.other)]
    assert len(SIDED) >= 20
    assert len(set(texts)) == len(texts)
    assert not training_texts & set(texts)


@pytest.mark.parametrize(
    ("text", "clip", "sign"),
    [
        ("wave over here with your left hand", "dataset-2_wave-right-hand_normal_001", -1),
        ("raise the left hand", "dataset-2_raise-up-left-hand_normal_001", 1),
        ("go for a walk and turn left", "dataset-2_walk-turn-right_normal_001", -1),
        ("go forward on foot", "02_01", 1),
        ("someone walks", "02_01", 1),
        ("someone walks", "09_01", -1),
    ],
)
def test_measures_have_the_sign_of_real_clips(real_paths, text, clip, sign):
    assert sign * _pair(text).measure(_clip(real_paths, clip)) > 0.0


def test_sided_measures_change_sign_with_the_side(real_paths):
    motion = _clip(real_paths, "dataset-2_wave-right-hand_normal_001")
    for pair in SIDED:
        assert pair.measure(motion.mirrored()) == pytest.approx(-pair.measure(motion), abs=1e-6)


def test_both_judges_side_with_real_clips(real_paths, encoder):
    evaluator = Evaluator.from_pretrained(shipped_evaluator(), encoder)
    right = _clip(real_paths, "dataset-2_wave-right-hand_normal_001").resample(20.0)
    pair = _pair("wave over here with your left hand")
    good = {pair.one: [right.mirrored()], pair.other: [right]}
    bad = {pair.one: [right], pair.other: [right.mirrored()]}
    assert [v.both for v in judge(pair, good, evaluator)] == [1, 1]
    assert [v.both for v in judge(pair, bad, evaluator)] == [0, 0]
