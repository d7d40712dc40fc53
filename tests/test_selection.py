from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.evaluation.evaluator import Evaluator, critic_of
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.selection import MATCH_MARGIN, TextMatch, eligible, leading
from motiondiffuse_ros.text import load_text_encoder

MATCHES = st.lists(st.one_of(st.none(), st.floats(-1, 1)), min_size=1, max_size=8)


@given(MATCHES)
def test_those_are_eligible_that_match_about_as_well_as_the_best(matches):
    known = [m for m in matches if m is not None]
    least = max(known, default=-2.0) - MATCH_MARGIN
    good = [i for i, m in enumerate(matches) if m is None or m >= least]
    found = eligible(dict(enumerate(matches)))
    assert sorted(found) == good != []
    judged = [matches[i] for i in found if matches[i] is not None]
    assert judged == sorted(judged, reverse=True)


@given(MATCHES, st.integers(1, 8))
def test_as_many_lead_as_are_asked_for_and_none_that_is_left_matches_better(matches, count):
    rows = leading(matches, count)
    known = {i: m for i, m in enumerate(matches) if m is not None}
    assert rows == sorted(set(rows))
    if known:
        assert len(rows) == min(count, len(known))
        least = min(known[i] for i in rows)
        assert all(m <= least for i, m in known.items() if i not in rows)
    else:
        assert rows == list(range(len(matches)))


def test_standing_still_does_not_win_by_being_plausible():
    assert eligible({0: 0.1, 3: 0.58, 7: 0.6}) == [7, 3]


def test_real_clips_match_their_own_words_and_side_best(real_paths):
    clips = {p.stem.split("_")[1]: load_motion(p).resample(20.0) for p in real_paths}
    critic = Evaluator.from_pretrained(critic_of(shipped_weights()), load_text_encoder("minilm"))
    asked = {
        "wave-right-hand": "a person waves with the right hand",
        "raise-up-left-hand": "a person raises the left hand",
        "walk-turn-right": "a person walks and turns right",
    }
    for kind, text in asked.items():
        own = clips[kind]
        candidates = [own, own.mirrored(), clips["bow"]]
        frames = min(m.frames for m in candidates)
        whole = (TimedText(text, 0, frames),)
        features = [PoseState().encode(motion) for motion in candidates]
        matches = TextMatch(critic, whole)(features)
        assert max(range(3), key=lambda i: matches[i]) == 0, (kind, matches)


def test_texts_on_parts_and_short_ones_are_not_judged(real_paths):
    motion = load_motion(real_paths[0]).resample(20.0)
    critic = Evaluator.from_pretrained(critic_of(shipped_weights()), load_text_encoder("minilm"))
    texts = (TimedText("waves", 0, 40, ("right_arm",)), TimedText("a person bows", 0, 10))
    assert TextMatch(critic, texts)([PoseState().encode(motion)]) == [None]
