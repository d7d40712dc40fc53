import json
from dataclasses import replace

import numpy as np
import pytest
from made_corpus import corpus_of
from small_denoiser import SMALL
from synthetic import standing, waving
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.corpus.statements import Statement, all_statements, state_in_reverse
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.errors import CheckpointError, InputError
from motiondiffuse_ros.motion.features import REPRESENTATIONS
from motiondiffuse_ros.training.config import TrainConfig
from motiondiffuse_ros.training.texts import other_words_of
from motiondiffuse_ros.training.trainer import STATE_FILE, Trainer
from motiondiffuse_ros.training.windows import WindowSampler, clip_probabilities

CONFIG = TrainConfig(minutes=0.05, batch_size=4, validate_steps=1, warmup_steps=1)


@pytest.fixture(scope="module")
def corpus():
    return corpus_of(
        [
            (f"{split}_{i}", split, text, motion)
            for split in ("train", "val")
            for i, (text, motion) in enumerate(
                [
                    ("a person stands", standing(20)),
                    ("a person waves with the right hand", waving(40)),
                ]
            )
        ]
    )


def test_a_run_leaves_a_checkpoint_a_log_and_can_be_resumed(corpus, encoder, tmp_path):
    trainer = Trainer(corpus, encoder, SMALL, CONFIG, tmp_path)
    before = trainer.validate()
    seen = []
    trainer.run(seen.append)
    assert trainer.validate() < before
    assert Checkpoint.from_pretrained(tmp_path / "checkpoint").denoiser.config == SMALL
    rows = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert any("validation" in row for row in rows)
    events = EventAccumulator(str(tmp_path)).Reload()
    assert "validation/plain" in events.Tags()["scalars"]

    with pytest.raises(CheckpointError, match="--resume"):
        Trainer(corpus, encoder, SMALL, CONFIG, tmp_path)
    longer = replace(CONFIG, minutes=CONFIG.minutes + 0.02)
    resumed = Trainer(corpus, encoder, SMALL, longer, tmp_path, resume=True)
    again = []
    resumed.run(again.append)
    assert again[0].step == seen[-1].step + 1
    assert again[0].minutes > seen[-1].minutes


def test_a_run_from_given_weights_begins_with_them_and_says_so(corpus, encoder, tmp_path):
    Trainer(corpus, encoder, SMALL, CONFIG, tmp_path / "one").run()
    weights = Checkpoint.from_pretrained(tmp_path / "one" / "checkpoint")
    other = Trainer(corpus, encoder, SMALL, CONFIG, tmp_path / "other", start=weights)
    other.save()
    again = Checkpoint.from_pretrained(tmp_path / "other" / "checkpoint")
    for name, tensor in weights.denoiser.state_dict().items():
        assert tensor.equal(again.denoiser.state_dict()[name]), name

    Trainer(corpus, encoder, SMALL, CONFIG, tmp_path / "other", resume=True)
    settings = json.loads((tmp_path / "other" / "config.json").read_text())
    assert settings["started_from"] == weights.sha256

    wider = replace(SMALL, width=2 * SMALL.width)
    with pytest.raises(CheckpointError, match="differ from this denoiser in width"):
        Trainer(corpus, encoder, wider, CONFIG, tmp_path / "wider", start=weights)


def test_resuming_nothing_or_something_broken_is_refused(corpus, encoder, tmp_path):
    with pytest.raises(CheckpointError, match="nothing to resume"):
        Trainer(corpus, encoder, SMALL, CONFIG, tmp_path, resume=True)
    (tmp_path / STATE_FILE).write_bytes(b"PK broken")
    with pytest.raises(CheckpointError, match="cannot be resumed"):
        Trainer(corpus, encoder, SMALL, CONFIG, tmp_path, resume=True)


def test_a_corpus_of_another_representation_is_refused(corpus, encoder, tmp_path):
    other = replace(corpus, representation=REPRESENTATIONS["humanml3d"]())
    with pytest.raises(CheckpointError, match="the corpus holds humanml3d"):
        Trainer(other, encoder, SMALL, CONFIG, tmp_path)
    assert not any(tmp_path.iterdir())


def test_mirrored_windows_have_mirrored_features_and_words(corpus):
    clip = next(c for c in corpus.clips if "right hand" in c.captions[0])
    sampler = WindowSampler(
        corpus, [clip], max_frames=64, mirror=1.0, texts=lambda c: c.captions, seed=0
    )
    batch = next(sampler.batches(4))
    assert set(batch.texts) == {"a person waves with the left hand"}
    features = corpus.statistics.denormalise(batch.features[0, :40].numpy())
    motion = corpus.representation.decode(features, 20.0)
    moving = {s: np.ptp(motion.joint(f"{s}_wrist"), axis=0).max() for s in ("left", "right")}
    assert moving["left"] > 10 * moving["right"]


def test_stated_windows_come_with_what_their_kinematics_say(corpus):
    sampler = WindowSampler(
        corpus, corpus.split("train"), max_frames=64, mirror=0.5, statements=1.0, seed=0
    )
    batch = next(sampler.batches(8))
    assert set(batch.texts) <= set(all_statements())
    for text, synonyms in zip(batch.texts, batch.synonyms, strict=True):
        assert text in synonyms


def test_rare_deeds_are_drawn_as_often_as_frequent_ones():
    texts = [*["a person dances"] * 30, "a person swings a golf club"]
    corpus = corpus_of([(str(i), "train", text, waving(40)) for i, text in enumerate(texts)])
    sampler = WindowSampler(
        *(corpus, corpus.clips),
        max_frames=64,
        mirror=0.0,
        deeds=1.0,
        texts=lambda clip: clip.captions,
        seed=0,
    )
    drawn = next(sampler.batches(200)).texts
    assert 70 < drawn.count("a person swings a golf club") < 130


def test_a_clip_comes_with_other_words_each_time_and_mostly_with_its_captions():
    corpus = corpus_of([("64_01", "train", "a person swings a golf club", waving(40))])
    (clip,) = corpus.clips
    sampler = WindowSampler(
        *(corpus, corpus.clips),
        max_frames=64,
        mirror=0.0,
        texts=lambda clip: clip.captions,
        other_words=other_words_of,
        seed=0,
    )
    batch = next(sampler.batches(200))
    others = [text for text in batch.texts if text not in clip.captions]
    assert set(others) <= set(other_words_of(clip))
    assert len(set(others)) > 20
    assert {len(own) for own in batch.synonyms} == {len(clip.captions) + 3}
    assert 120 < len(others) < 180  # three texts of four


def test_walks_are_also_shown_in_reverse_as_walking_backward(real_paths):
    walk = load_motion(next(p for p in real_paths if p.stem == "02_01")).resample(20.0)
    walks = corpus_of([("02_01", "train", "a person walks", walk)])
    sampler = WindowSampler(walks, walks.clips, max_frames=64, mirror=0.0, statements=1.0, seed=0)
    batch = next(sampler.batches(32))
    going_back = state_in_reverse(Statement("walk", ()))
    assert going_back is not None
    backward = [i for i, text in enumerate(batch.texts) if text in going_back.texts]
    assert 0 < len(backward) < 32
    for i, row in enumerate(batch.features.numpy()):
        features = walks.statistics.denormalise(row[: batch.lengths[i]])
        end = walks.representation.decode(features, 20.0).root[-1, 0]
        assert end < -0.5 if i in backward else end > 0.5, batch.texts[i]


def test_bad_settings_are_refused():
    with pytest.raises(InputError, match="batch_size must be positive"):
        TrainConfig(batch_size=0).validate()
    with pytest.raises(InputError, match="mirror must be from 0 to 1"):
        TrainConfig(mirror=1.5).validate()
    with pytest.raises(InputError, match=r"shares of one whole, got 0\.7 and 0\.4"):
        TrainConfig(statements=0.7, deeds=0.4).validate()


def test_many_takes_of_one_gesture_do_not_crowd_out_the_rest(corpus):
    clip = corpus.clips[0]
    takes = [replace(clip, name=f"take_{i}") for i in range(100)]
    other = replace(clip, captions=("a person bows",))
    foreign = replace(clip, dataset="another")
    share = clip_probabilities([*takes, other, foreign], 784)
    np.testing.assert_allclose(share.sum(), 1.0)
    np.testing.assert_allclose(share[-1], 0.5)  # a data set of its own
    np.testing.assert_allclose(share[:100].sum() / share[100], 100**0.3)
