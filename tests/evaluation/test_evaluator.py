from dataclasses import replace

import numpy as np
import pytest
import torch
from torch.nn import functional as F

from motiondiffuse_ros.errors import CheckpointError, TextEncoderError
from motiondiffuse_ros.evaluation.actions import action_of, actions_of
from motiondiffuse_ros.evaluation.config import EvaluatorConfig, EvaluatorTraining
from motiondiffuse_ros.evaluation.evaluator import Evaluator
from motiondiffuse_ros.evaluation.training import not_wrong, train_evaluator
from motiondiffuse_ros.training.windows import WindowBatch


def _features(corpus, kind):
    return [corpus.of(c) for c in corpus.split("test") if f"_{kind}_" in c.name]


def test_it_tells_texts_and_sides_apart(made_corpus, evaluator):
    texts = ["a person waves the right hand", "a person waves the left hand", "a person stands"]
    text = evaluator.embed_texts(texts)
    motion = evaluator.embed_motions(
        [_features(made_corpus, k)[0] for k in ("wave-right-hand", "wave-left-hand", "stand")]
    )
    np.testing.assert_allclose(np.linalg.norm(text, axis=1), 1.0, atol=1e-5)
    assert (text @ motion.T).argmax(axis=1).tolist() == [0, 1, 2]


def test_it_recognises_actions(made_corpus, evaluator):
    for kind in ("stand", "wave-right-hand", "wave-left-hand", "glide"):
        found = evaluator.recognise(_features(made_corpus, kind))
        assert {evaluator.actions[i] for i in found} == {kind.replace("-", " ")}


def test_neither_order_nor_company_changes_an_embedding(made_corpus, evaluator):
    features = [made_corpus.of(c)[: 40 + i] for i, c in enumerate(made_corpus.clips[:6])]
    together = evaluator.embed_motions(features)
    apart = np.concatenate([evaluator.embed_motions([f]) for f in reversed(features)])[::-1]
    np.testing.assert_allclose(together, apart, atol=1e-4)


def test_it_comes_back_from_its_folder(made_corpus, evaluator, encoder, tmp_path):
    evaluator.save_pretrained(tmp_path)
    again = Evaluator.from_pretrained(tmp_path, encoder)
    features = _features(made_corpus, "glide")[:2]
    # float16 on disk
    np.testing.assert_allclose(
        again.embed_motions(features), evaluator.embed_motions(features), atol=0.02
    )
    assert again.actions == evaluator.actions

    class Other:
        name, dim, sha256 = "other", 384, "0" * 64

        def encode(self, texts):
            raise AssertionError

    with pytest.raises(TextEncoderError, match="was trained with"):
        Evaluator.from_pretrained(tmp_path, Other())
    weights = tmp_path / "text_motion.safetensors"
    weights.write_bytes(weights.read_bytes()[:-1])
    with pytest.raises(CheckpointError, match="truncated or altered"):
        Evaluator.from_pretrained(tmp_path, encoder)
    with pytest.raises(CheckpointError, match=r"no config\.json"):
        Evaluator.from_pretrained(tmp_path / "none", encoder)


def test_another_right_answer_is_not_held_against_a_pair():
    texts = [
        "a person waves",
        "somebody waves a hand",
        "a person turns left",
        "a person turns right",
    ]
    synonyms = [frozenset(texts[:2]), frozenset(texts[:2]), *(frozenset([t]) for t in texts[2:])]
    batch = WindowBatch(torch.zeros(4, 1, 1), torch.ones(4), texts, synonyms)
    apart = torch.eye(4)
    mask = not_wrong(batch, apart)
    assert mask.nonzero().tolist() == [[0, 1], [1, 0]]
    # near in the encoder's space: the same words of direction are needed too
    near = F.normalize(torch.ones(4, 4) + 0.01 * torch.eye(4), dim=-1)
    assert mask.sum() == 2
    assert not not_wrong(batch, near)[2, 3]


def test_actions_are_the_words_of_the_file_names(made_corpus):
    assert actions_of(made_corpus.clips) == (
        "glide",
        "stand",
        "wave left hand",
        "wave right hand",
    )
    assert action_of(made_corpus.clips[0]) == "stand"


def test_a_corpus_without_actions_gives_an_evaluator_without_recogniser(
    made_corpus, encoder, tmp_path
):
    clips = tuple(replace(c, name=f"clip{i}") for i, c in enumerate(made_corpus.clips))
    config = EvaluatorConfig(width=32, motion_layers=1, text_layers=1, space=16)
    few = EvaluatorTraining(steps=2, batch_size=4, statements=0.0)
    made = train_evaluator(replace(made_corpus, clips=clips), encoder, config, few)
    made.save_pretrained(tmp_path)
    loaded = Evaluator.from_pretrained(tmp_path, encoder)
    assert loaded.actions == ()
    assert loaded.embed_motions([made_corpus.of(clips[0])]).shape == (1, 16)
    with pytest.raises(CheckpointError, match="without actions"):
        loaded.recognise([made_corpus.of(clips[0])])
