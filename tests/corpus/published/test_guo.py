"""HumanML3D and KIT-ML, which share a layout."""

import shutil

import numpy as np
import pytest
from synthetic import drifting, standing, waving

from motiondiffuse_ros.corpus.build import BuildConfig, build_corpus
from motiondiffuse_ros.corpus.published import HumanML3DFolder, KitMLFolder
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.errors import CorpusError

BOTH = pytest.mark.parametrize("importer", [HumanML3DFolder, KitMLFolder])
WHOLE = "a person waves.#a/DET person/NOUN wave/VERB#0.0#0.0\n"


def write_folder(folder, importer, clips):
    """Write (split, name, motion, text) in the published layout."""
    for part in ("new_joint_vecs", "texts"):
        (folder / part).mkdir(parents=True)
    for split in ("train", "val", "test"):
        names = [name for s, name, _, _ in clips if s == split]
        (folder / f"{split}.txt").write_text("".join(f"{name}\n" for name in names))
    for _, name, motion, text in clips:
        np.save(folder / "new_joint_vecs" / f"{name}.npy", importer.representation.encode(motion))
        (folder / "texts" / f"{name}.txt").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def clips():
    walk, wave, still = drifting(standing(120), 1.0), waving(60), standing(60)
    pieces = (
        "someone walks.#someone/PRON walk/VERB#nan#nan\n"
        "a man strolls along.#a/DET man/NOUN stroll/VERB along/ADV#0.0#0.0\n"
        "he takes steps.#he/PRON take/VERB step/NOUN#1.5#5.0\n"
        "he moves ahead.#he/PRON move/VERB ahead/ADV#1.5#5.0\n"
        "he twitches.#he/PRON twitch/VERB#1.0#1.5\n"
    )
    return [
        ("train", "000001", walk, pieces),
        ("train", "M000001", walk.mirrored(), WHOLE),
        ("val", "000002", wave, WHOLE),
        ("test", "000003", still, "a person stands – calmly.#a/DET person/NOUN#0.0#0.0\n"),
        ("test", "000004", standing(10), WHOLE),
        ("test", "000005", standing(220), WHOLE),
    ]


@BOTH
def test_clips_pieces_captions_and_splits_are_as_published(tmp_path, importer, clips):
    dataset = importer(write_folder(tmp_path, importer, clips))
    (tmp_path / "train.txt").write_text("000001\nM000001\n000009\n")
    corpus = build_corpus(BuildConfig((), (), published=(dataset,)))
    found = {c.name: (c.split, c.captions) for c in corpus.clips}
    assert found == {
        "000001": ("train", ("someone walks.", "a man strolls along.")),
        "000001_1.5-5": ("train", ("he takes steps.", "he moves ahead.")),
        "000002": ("val", ("a person waves.",)),
        "000003": ("test", ("a person stands – calmly.",)),
    }
    length = f"not {importer.min_frames} to 199 frames"
    assert corpus.dropped == {"mirror image": 1, "no motion file": 1, length: 3}
    assert corpus.fps == importer.fps
    assert corpus.representation.name == importer.name
    assert {c.dataset for c in corpus.clips} == {importer.name}


@BOTH
def test_features_stay_as_published_and_pieces_are_cut_by_time(tmp_path, importer, clips):
    write_folder(tmp_path, importer, clips)
    corpus = build_corpus(BuildConfig((), (), published=(importer(tmp_path),)))
    published = np.load(tmp_path / "new_joint_vecs" / "000001.npy")
    by_name = {c.name: corpus.of(c) for c in corpus.clips}
    np.testing.assert_array_equal(by_name["000001"], published)
    cut = slice(int(1.5 * importer.fps), int(5.0 * importer.fps))
    np.testing.assert_array_equal(by_name["000001_1.5-5"], published[cut])


@BOTH
def test_the_corpus_folder_decodes_to_motion(tmp_path, importer, clips):
    write_folder(tmp_path / "raw", importer, clips)
    build_corpus(BuildConfig((), (), published=(importer(tmp_path / "raw"),))).save(tmp_path / "c")
    corpus = Corpus.load(tmp_path / "c")
    walk = next(c for c in corpus.clips if c.name == "000001")
    motion = corpus.representation.decode(corpus.of(walk), corpus.fps)
    expected = clips[0][2].canonicalised().positions
    assert np.linalg.norm(motion.positions - expected, axis=-1).max() < 0.02
    wave = next(c for c in corpus.clips if c.name == "000002")
    raised = corpus.representation.decode(corpus.of(wave), corpus.fps)
    assert (raised.joint("right_wrist")[:, 2] > raised.joint("left_wrist")[:, 2]).all()


def test_the_real_sample_builds_a_corpus(tmp_path, humanml3d_sample):
    folder = tmp_path / "HumanML3D"
    shutil.copytree(humanml3d_sample / "new_joint_vecs", folder / "new_joint_vecs")
    (folder / "texts").mkdir()
    (folder / "texts" / "012314.txt").write_text("a person moves#a/DET person/NOUN#0.0#0.0\n")
    for split, names in (("train", "012314\n"), ("val", ""), ("test", "M012314\n")):
        (folder / f"{split}.txt").write_text(names)
    corpus = build_corpus(BuildConfig((), (), published=(HumanML3DFolder(folder),)))
    (clip,) = corpus.clips
    assert (clip.name, clip.split, clip.frames) == ("012314", "train", 170)
    assert corpus.dropped == {"mirror image": 1}
    assert np.isfinite(corpus.statistics.normalise(corpus.of(clip))).all()


@BOTH
def test_a_clip_that_is_not_finite_or_has_no_text_is_dropped(tmp_path, importer, clips):
    write_folder(tmp_path, importer, clips)
    path = tmp_path / "new_joint_vecs" / "000002.npy"
    np.save(path, np.full_like(np.load(path), np.nan))
    (tmp_path / "texts" / "000003.txt").unlink()
    corpus = build_corpus(BuildConfig((), (), published=(importer(tmp_path),)))
    assert corpus.dropped["not finite"] == 1
    assert corpus.dropped["no text file"] == 1


def _build(folder):
    build_corpus(BuildConfig((), (), published=(HumanML3DFolder(folder),)))


def test_what_is_missing_is_named(tmp_path, clips):
    with pytest.raises(CorpusError, match=r"new_joint_vecs: missing"):
        _build(tmp_path)
    folder = write_folder(tmp_path / "raw", HumanML3DFolder, clips)
    (folder / "val.txt").unlink()
    with pytest.raises(CorpusError, match=r"val\.txt: missing.*lists the clips"):
        _build(folder)
    for split in ("train", "val", "test"):
        (folder / f"{split}.txt").write_text("000077\n")
    with pytest.raises(CorpusError, match=r"new_joint_vecs: holds no clip"):
        _build(folder)


def test_features_of_another_size_are_refused(tmp_path, clips):
    folder = write_folder(tmp_path, KitMLFolder, clips)
    with pytest.raises(CorpusError, match=r"000001\.npy: has shape \(120, 251\).*\[T, 263\]"):
        _build(folder)
    (folder / "new_joint_vecs" / "000001.npy").write_bytes(b"not an array")
    with pytest.raises(CorpusError, match=r"000001\.npy: not a numpy array"):
        _build(folder)


def test_a_text_line_of_another_form_is_refused(tmp_path, clips):
    folder = write_folder(tmp_path, HumanML3DFolder, clips)
    (folder / "texts" / "000001.txt").write_text(WHOLE + "a person walks\n")
    with pytest.raises(CorpusError, match=r"000001\.txt, line 2: expected caption#tokens"):
        _build(folder)
