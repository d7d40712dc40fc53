import shutil
from dataclasses import replace

import numpy as np

from motiondiffuse_ros.corpus.build import BuildConfig, Source, build_corpus
from motiondiffuse_ros.corpus.captions import shipped_caption_files
from motiondiffuse_ros.corpus.copies import without_copies
from motiondiffuse_ros.corpus.published.dataset import ImportedClip


def _clip(name, caption, split="train", of=0):
    return ImportedClip(name, split, (caption,), np.full((30, 4), of, np.float32))


def _names(clips):
    return [clip.name for clip in clips]


def test_the_copy_whose_caption_says_more_stays():
    vague, telling = _clip("122_41", "a person walks"), _clip("83_41", "a person hops forward")
    other = _clip("122_42", "a person walks", of=1)
    assert _names(without_copies([vague, telling, other])) == ["83_41", "122_42"]
    assert _names(without_copies([other, telling, vague])) == ["122_42", "83_41"]


def test_a_motion_is_for_training_if_any_copy_is():
    seen, unseen = _clip("a", "a person walks", "train"), _clip("b", "a person walks", "test")
    assert [c.split for c in without_copies([unseen, seen])] == ["train"]
    other = replace(seen, split="test")
    assert [c.split for c in without_copies([unseen, other])] == ["test"]


def test_copies_of_one_name_are_told_apart():
    one, same = _clip("a", "a person walks"), _clip("a", "a person walks")
    assert _names(without_copies([one, same])) == ["a"]
    other, twin = _clip("a", "a person walks", of=1), _clip("b", "a person hops")
    stay = without_copies([one, other, twin])
    assert [(c.name, c.features[0, 0]) for c in stay] == [("a", 1), ("b", 0)]


def test_clips_that_differ_all_stay():
    clips = [_clip(str(i), "a person walks", of=i) for i in range(5)]
    assert _names(without_copies(clips)) == _names(clips)


def test_a_corpus_has_every_motion_once_and_says_what_was_dropped(real_clips, tmp_path):
    original = next((real_clips / "cmu").glob("02_01.bvh"))
    for name in ("02_01", "999_01"):
        shutil.copy(original, tmp_path / f"{name}.bvh")
    captions = tmp_path / "more.jsonl"
    captions.write_text('{"key": "999_01", "captions": ["a person walks"]}\n')
    config = BuildConfig(
        (Source("cmu", tmp_path),), (*shipped_caption_files(), captions), workers=1
    )
    corpus = build_corpus(config)
    assert len(corpus.clips) == 1
    assert corpus.dropped == {"copy of another clip": 1}
