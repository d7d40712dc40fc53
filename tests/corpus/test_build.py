import numpy as np
import pytest

from motiondiffuse_ros.corpus.build import BuildConfig, Source, build_corpus
from motiondiffuse_ros.corpus.captions import shipped_caption_files
from motiondiffuse_ros.corpus.split import SPLITS, split_of
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.errors import CorpusError


@pytest.fixture(scope="module")
def corpus(real_clips, tmp_path_factory):
    folder = real_clips / "bandai-namco"
    broken = folder / "dataset-1_bow_broken_001.bvh"
    broken.write_text("HIERARCHY nothing")
    captions = tmp_path_factory.mktemp("captions") / "more.jsonl"
    captions.write_text('{"key": "dataset-1_bow_broken", "captions": ["a person bows"]}\n')
    # two sources of one file each way: the uncaptioned clip is a copy under another name
    (folder / "uncaptioned_001.bvh").write_text(next(folder.glob("*run*")).read_text())
    config = BuildConfig(
        (Source("cmu", real_clips / "cmu"), Source("bandai_namco", folder)),
        (*shipped_caption_files(), captions),
        workers=1,
    )
    built = build_corpus(config)
    broken.unlink()
    (folder / "uncaptioned_001.bvh").unlink()
    return built


def test_every_clip_is_kept_or_dropped_with_a_reason(corpus):
    assert len(corpus.clips) == 12
    assert corpus.dropped == {"unreadable": 1, "no caption": 1}
    assert all(c.captions and c.split in SPLITS for c in corpus.clips)


def test_statistics_normalise_and_are_symmetric(corpus):
    train = np.concatenate([corpus.of(c) for c in corpus.split("train")])
    index, sign = corpus.representation.mirror()
    both = np.concatenate([train, train[:, index] * sign])
    np.testing.assert_allclose(corpus.statistics.normalise(both).mean(axis=0), 0.0, atol=0.01)
    mean = corpus.statistics.mean
    np.testing.assert_allclose(mean, mean[index] * sign, atol=1e-4)


def test_folder_round_trip(corpus, tmp_path):
    corpus.save(tmp_path)
    loaded = Corpus.load(tmp_path)
    assert loaded.clips == corpus.clips
    np.testing.assert_array_equal(loaded.features, corpus.features)
    assert loaded.dropped == corpus.dropped


def test_split_depends_on_the_name_alone_and_has_its_shares():
    names = [f"clip_{i:04}" for i in range(4000)]
    splits = [split_of("set", name) for name in names]
    assert splits == [split_of("set", name) for name in names]
    assert 0.82 < splits.count("train") / 4000 < 0.88
    assert 0.08 < splits.count("test") / 4000 < 0.12


def test_unknown_split_is_refused(corpus):
    with pytest.raises(CorpusError, match="train, val, test, all"):
        corpus.split("validation")


def test_nothing_to_build_from_is_refused(tmp_path):
    with pytest.raises(CorpusError, match=r"no \.bvh file"):
        build_corpus(BuildConfig((Source("cmu", tmp_path),), ()))


def test_a_folder_that_is_no_corpus_is_refused(tmp_path):
    with pytest.raises(CorpusError, match="corpus build"):
        Corpus.load(tmp_path)
