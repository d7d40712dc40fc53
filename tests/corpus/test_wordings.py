import re

import pytest

from motiondiffuse_ros.corpus.captions import mirror_caption, read_captions, shipped_caption_files
from motiondiffuse_ros.corpus.statements import all_statements, sentences_by_kind
from motiondiffuse_ros.corpus.store import Clip
from motiondiffuse_ros.corpus.wordings import DONE, STATED, all_wordings, wordings, wordings_of_clip
from motiondiffuse_ros.evaluation.actions import action_of


def _said_first():
    """Return what patterns are matched with: labels and first captions of the shipped files."""
    for name, captions in read_captions(shipped_caption_files()).items():
        if not captions:
            continue
        yield captions[0].removeprefix("a person ")
        label = action_of(Clip(f"{name}_001", "bandai-namco", "train", captions, 0, 1))
        if label is not None:
            yield label


def test_every_kind_of_statement_has_other_words():
    assert set(STATED) == set(sentences_by_kind())


@pytest.mark.parametrize("pattern", DONE)
def test_every_pattern_is_for_clips_that_there_are(pattern):
    assert any(re.fullmatch(pattern, deed) for deed in _said_first())


@pytest.mark.parametrize(
    "text",
    [
        "walk on and curve left",
        "walking on and curving left",
        "having a seat",
        "sidestepping left",
        "bouncing repeatedly on the left foot",
        "tiptoeing along",
    ],
)
def test_a_phrase_is_also_a_bare_doing(text):
    assert text in all_wordings()


@pytest.mark.parametrize(
    "deed", ["waves the hands", "throws and catches a ball", "has a seat", "hurries along walking"]
)
def test_a_phrase_is_also_said_about_somebody(deed):
    assert any(text.endswith(f" {deed}") for text in all_wordings())


def test_what_is_said_about_somebody_has_verbs_of_the_third_person():
    for text in all_wordings():
        if text.startswith(("he ", "she ", "someone ")):
            verb, *rest = text.split()[1:]
            assert verb.endswith("s"), text
            assert "your" not in rest, text


def test_sided_ones_are_mirrored_and_distances_filled_in():
    assert "balancing on the left foot" in {mirror_caption(t) for t in wordings("one leg up")}
    said = set(all_statements())
    assert set(map(mirror_caption, wordings("circle"))) <= said
    assert {text.format(n="three meters") for text in wordings("distance")} <= said
    assert not any("{" in text for text in said)


def test_a_clip_has_some_and_always_the_same():
    deeds = ("swings a golf club",)
    texts = wordings_of_clip("64_01", deeds)
    assert len(texts) == len(set(texts)) == 48
    assert wordings_of_clip("64_01", deeds) == texts
    assert wordings_of_clip("64_02", deeds) != texts
    assert wordings_of_clip("64_01", ("poses like the thinker",)) == ()
