from dataclasses import replace

import numpy as np
import pytest

from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.evaluation.action_protocol import evaluate_actions
from motiondiffuse_ros.evaluation.plausibility import MEASURES
from motiondiffuse_ros.evaluation.protocol import Protocol, evaluate_texts
from motiondiffuse_ros.evaluation.sources import NearestCaption, RandomClip
from motiondiffuse_ros.evaluation.tables import (
    markdown_table,
    metrics_cells,
    plausibility_cells,
    rows_from_json,
    rows_to_json,
)

PROTOCOL = Protocol(repeats=2, texts_sampled=2, samples=3, plausible_motions=6)


class Perfect:
    """Answers every text with the test clip it belongs to: what no model can beat."""

    name, generates = "perfect", True

    def __init__(self, corpus):
        self._of = {c.captions[0]: corpus.of(c) for c in corpus.split("test")}
        self._corpus = corpus

    def motions(self, texts, frames, seed, own):
        return [self._of[t][:f] for t, f in zip(texts, frames, strict=True)]


@pytest.fixture(scope="module")
def rows(made_corpus, evaluator, encoder):
    train = made_corpus.split("train")
    sources = (
        RandomClip(made_corpus, train),
        NearestCaption(made_corpus, train, encoder),
        Perfect(made_corpus),
    )
    found = evaluate_texts(made_corpus, "test", evaluator, sources, PROTOCOL)
    return {row.name: row for row in found}


def test_answers_rank_as_they_should(rows):
    top3 = {
        name: row.metrics["r_precision_top3"].mean
        for name, row in rows.items()
        if "r_precision_top3" in row.metrics
    }
    assert top3["perfect"] == top3["real"]
    assert top3["real"] > top3["random"]
    assert top3["retrieval"] > top3["random"]
    distance = {n: rows[n].metrics["mm_dist"].mean for n in top3}
    assert distance["perfect"] == distance["real"] < distance["random"]


def test_the_same_motions_have_no_distance_and_no_variety(rows):
    assert rows["perfect"].metrics["fid"].mean == pytest.approx(0.0, abs=1e-4)
    assert rows["perfect"].metrics["multimodality"].mean == pytest.approx(0.0, abs=1e-6)
    assert rows["random"].metrics["fid"].mean > rows["perfect"].metrics["fid"].mean


def test_physics_is_measured_on_the_same_clips(rows):
    for measure in MEASURES:
        assert rows["perfect"].metrics[measure].mean == rows["real"].metrics[measure].mean
    # training clips answer no text
    assert set(rows["training"].metrics) == {"fid", "diversity"}


def test_actions_are_recognised(made_corpus, evaluator, encoder):
    sources = (
        RandomClip(made_corpus, made_corpus.split("train")),
        NearestCaption(made_corpus, made_corpus.split("train"), encoder),
    )
    rows = {r.name: r for r in evaluate_actions(made_corpus, "test", evaluator, sources, PROTOCOL)}
    accuracy = {name: row.metrics["accuracy"].mean for name, row in rows.items()}
    assert accuracy["real"] == 1.0
    assert accuracy["retrieval"] > accuracy["random"]


def test_the_same_seed_gives_the_same_figures(made_corpus, evaluator):
    def figures(seed):
        source = RandomClip(made_corpus, made_corpus.split("train"))
        protocol = Protocol(repeats=1, plausible_motions=2, seed=seed)
        return rows_to_json(evaluate_texts(made_corpus, "test", evaluator, [source], protocol))

    assert figures(0) == figures(0)
    assert figures(0) != figures(1)


def test_tables_have_a_line_for_every_row(rows):
    cells = metrics_cells(list(rows.values()))
    names = ["real motion", "real training clips", "random clip", "nearest caption", "perfect"]
    assert [line[0] for line in cells[1:]] == names
    assert "–" in cells[2]
    text = markdown_table(cells)
    assert text.count("\n") == len(rows) + 2
    assert plausibility_cells(list(rows.values()))[0][1] == "phys-err mm"
    assert metrics_cells(rows_from_json(rows_to_json(list(rows.values())))) == cells


@pytest.mark.parametrize(
    ("field", "value"), [("repeats", 0), ("samples", 1), ("plausible_motions", 0)]
)
def test_bad_protocols_are_refused(field, value):
    with pytest.raises(InputError, match=field):
        Protocol(**{field: value}).validate()


def test_a_split_too_small_for_a_pool_is_refused(made_corpus, evaluator):
    few = (
        tuple(c for c in made_corpus.clips if c.split != "test")[:80]
        + tuple(c for c in made_corpus.clips if c.split == "test")[:5]
    )
    with pytest.raises(InputError, match="a pool needs 32"):
        evaluate_texts(replace(made_corpus, clips=few), "test", evaluator, [], PROTOCOL)


def test_random_clips_are_windows_of_the_asked_length(made_corpus):
    source = RandomClip(made_corpus, made_corpus.split("train"))
    own = made_corpus.split("test")[:3]
    answers = source.motions(["a"] * 3, [40, 41, 100], 0, own)
    assert [len(a) for a in answers] == [40, 41, 48]
    assert np.isfinite(np.concatenate(answers)).all()


def test_where_every_clip_is_asked_for_none_is_its_own_answer(made_corpus, evaluator, encoder):
    # each glides at a speed of its own
    clips = [c for c in made_corpus.split("test") if "glide" in c.name]
    nearest = NearestCaption(made_corpus, clips, encoder)
    answers = nearest.motions([c.captions[0] for c in clips], [48] * len(clips), 0, clips)
    for clip, answer in zip(clips, answers, strict=True):
        assert len(answer) == clip.frames
        assert not np.array_equal(answer, made_corpus.of(clip))
    unseen = replace(made_corpus, clips=made_corpus.split("test"))
    rows = evaluate_texts(unseen, "all", evaluator, [nearest], PROTOCOL)
    assert [row.name for row in rows] == ["real", "retrieval"]


def test_a_split_without_a_pool_of_different_captions_is_refused(made_corpus, evaluator):
    # each caption occurs in all three splits
    with pytest.raises(InputError, match="32 different captions"):
        evaluate_texts(made_corpus, "all", evaluator, [], PROTOCOL)
