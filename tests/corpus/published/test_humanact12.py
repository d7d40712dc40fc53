import numpy as np
import pytest
from synthetic import drifting, moved, standing, waving

from motiondiffuse_ros.corpus.build import BuildConfig, build_corpus
from motiondiffuse_ros.corpus.published import HumanAct12
from motiondiffuse_ros.corpus.split import split_of
from motiondiffuse_ros.errors import CorpusError

WALK, WAVE, THROW = (
    f"P0{i}G01R02F0001T0060A{action}" for i, action in ((1, "0201"), (2, "0101"), (3, "1202"))
)


def write_clip(folder, name, motion):
    """Write the 24 joints as a camera two and a half metres away sees them: y down, z away."""
    left, up, ahead = (motion.positions[..., axis] for axis in (1, 2, 0))
    joints = np.stack([left, 1.0 - up, 2.5 - ahead], axis=-1)
    hands = joints[:, 20:22] + [0.0, 0.05, 0.0]
    np.save(folder / f"{name}.npy", np.concatenate([joints, hands], axis=1))


@pytest.fixture
def folder(tmp_path):
    motions = {WALK: drifting(standing(60), 1.0), WAVE: waving(60), THROW: standing(60)}
    for name, motion in motions.items():
        write_clip(tmp_path, name, motion)
    return tmp_path


def test_clips_are_read_with_their_class_and_decode_to_the_motion(folder):
    corpus = build_corpus(BuildConfig((), (), published=(HumanAct12(folder),)))
    clips = {c.name: c for c in corpus.clips}
    captions = {name: clip.captions for name, clip in clips.items()}
    assert captions == {WALK: ("walk",), WAVE: ("warm up",), THROW: ("throw",)}
    assert all(c.split == split_of("humanact12", c.name) for c in corpus.clips)
    assert (corpus.representation.name, corpus.fps) == ("joint_positions", 20.0)
    for name, expected in ((WALK, drifting(standing(60), 1.0)), (WAVE, waving(60))):
        found = corpus.representation.decode(corpus.of(clips[name]), corpus.fps)
        error = np.abs(found.positions - expected.canonicalised().positions)
        assert error.max() < 0.01


def test_a_floating_camera_does_not_lift_the_floor(folder):
    write_clip(folder, WAVE, moved(waving(60), np.array([0.3, 0.2, 0.7])))
    corpus = build_corpus(BuildConfig((), (), published=(HumanAct12(folder),)))
    clip = next(c for c in corpus.clips if c.name == WAVE)
    motion = corpus.representation.decode(corpus.of(clip), corpus.fps)
    assert abs(motion.joint("left_foot")[:, 2].min() - 0.02) < 0.01


def test_short_and_broken_clips_are_dropped(folder):
    write_clip(folder, "P09G01R01F0001T0008A0201", standing(8))
    write_clip(folder, "P09G01R01F0001T0060A0301", standing(60))
    path = folder / "P09G01R01F0001T0060A0301.npy"
    np.save(path, np.full((60, 24, 3), np.nan))
    write_clip(folder, "P09G01R01F0001T0060A0401", standing(60))
    path = folder / "P09G01R01F0001T0060A0401.npy"
    np.save(path, np.load(path) * (np.arange(60) != 30)[:, None, None])
    write_clip(folder, "P09G01R01F0001T0060A0501", standing(60))
    path = folder / "P09G01R01F0001T0060A0501.npy"
    np.save(path, np.load(path) * [1.0, -1.0, -1.0])
    corpus = build_corpus(BuildConfig((), (), published=(HumanAct12(folder),)))
    assert corpus.dropped == {
        "shorter than 0.8 s": 1,
        "not finite": 1,
        "joints coincide": 1,
        "head below the feet (as published, y points down)": 1,
    }


@pytest.mark.parametrize("name", ["walk", "P01G01R02F0001T0060A1301", "P01G01R02F0001T0060A0001"])
def test_another_name_is_refused(folder, name):
    write_clip(folder, name, standing(30))
    with pytest.raises(CorpusError, match=rf"{name}\.npy: not a name of HumanAct12"):
        build_corpus(BuildConfig((), (), published=(HumanAct12(folder),)))


def test_another_shape_and_an_empty_folder_are_refused(folder, tmp_path):
    np.save(folder / f"{WALK}.npy", np.zeros((60, 18, 3)))
    with pytest.raises(CorpusError, match=r"A0201\.npy: has shape \(60, 18, 3\).*\[T, 24, 3\]"):
        build_corpus(BuildConfig((), (), published=(HumanAct12(folder),)))
    with pytest.raises(CorpusError, match=r"no \.npy file"):
        build_corpus(BuildConfig((), (), published=(HumanAct12(tmp_path / "none"),)))
