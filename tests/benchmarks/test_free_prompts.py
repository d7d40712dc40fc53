import pytest
from synthetic import jumping_jack, standing, waving

from benchmarks.free_prompts import FREE_PROMPTS
from benchmarks.kinematic_rules import (
    both_hands_up,
    goes_ahead,
    hand_up,
    is_still,
    jumping_jacks,
    nods_down,
    speed_is,
    turns,
)
from benchmarks.tuning_prompts import TUNING_PROMPTS
from motiondiffuse_ros.corpus.importer import load_motion


def _clip(paths, name):
    return load_motion(next(p for p in paths if p.stem == name)).canonicalised()


def test_no_prompt_is_a_text_of_the_training_data(training_texts):
    assert not training_texts & set(FREE_PROMPTS)
    assert len(FREE_PROMPTS) >= 60


def test_none_was_used_to_choose_settings():
    assert not set(TUNING_PROMPTS) & set(FREE_PROMPTS)


def test_doing_nothing_satisfies_only_the_prompts_that_ask_for_it():
    idle = standing(101)
    assert {text for text, rule in FREE_PROMPTS.items() if rule.holds(idle)} == {
        "just stand there",
        "wait and do nothing",
    }


@pytest.mark.parametrize(
    ("clip", "rule"),
    [
        ("02_01", goes_ahead(1.5) & speed_is(0.4, 2.0)),
        ("09_01", goes_ahead(2.0) & speed_is(2.0)),
        ("dataset-1_bow_active_001", nods_down(0.15)),
        ("dataset-2_raise-up-left-hand_normal_001", hand_up("left")),
        ("dataset-2_wave-right-hand_normal_001", hand_up("right")),
        ("dataset-2_walk-turn-right_normal_001", turns("right", 40.0)),
    ],
)
def test_rules_hold_on_real_clips_of_what_they_ask_for(real_paths, clip, rule):
    motion = _clip(real_paths, clip)
    assert rule.holds(motion)
    assert not is_still().holds(motion)
    assert not both_hands_up().holds(motion)


def test_a_side_is_not_the_other_one():
    motion = waving(60)
    assert hand_up("right").holds(motion) == hand_up("left").holds(motion.mirrored())
    assert not (hand_up("right").holds(motion) and hand_up("left").holds(motion))


def test_jumping_jacks_take_arms_and_legs_more_than_once():
    assert jumping_jacks(2).holds(jumping_jack(times=3))
    assert not jumping_jacks(2).holds(jumping_jack(times=1))
    assert not jumping_jacks(1).holds(jumping_jack(times=3, legs=0.0))
    assert not jumping_jacks(1).holds(jumping_jack(times=3, arms=0.0))
