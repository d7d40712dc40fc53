import pickle

import numpy as np
import pytest
from smpl_poses import smpl_poses
from synthetic import drifting, standing, waving

from motiondiffuse_ros.corpus.build import BuildConfig, build_corpus
from motiondiffuse_ros.corpus.published import Uestc
from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion import rotations as rot

CAMERA = rot.about_axis(0, np.array(np.pi))  # y down, z away
CLIPS = {
    "a0_d1_p001_c1_color.avi": drifting(standing(60, 30.0), 1.0),  # 1 trains
    "a2_d3_p003_c2_color.avi": waving(60, 30.0),  # 3 tests
    "a1_d8_p001_c2_color.avi": standing(60, 30.0),  # a view without a direction
    "a1_d8_p002_c1_color.avi": standing(60, 30.0),
}


def vibe_of(motion):
    """Return pose, joints3d and orig_cam as VIBE gives them."""
    pose, root = smpl_poses(motion, CAMERA, 24)
    joints = np.zeros((motion.frames, 49, 3))  # around the middle of the hips
    depth = 3.0 + root[:, 2]
    scale = 500.0 / (0.5 * 540.0 * depth)
    camera = np.stack([scale, 16 / 9 * scale, root[:, 0], root[:, 1]], axis=-1)
    return {"pose": pose, "joints3d": joints, "orig_cam": camera}


def write_folder(folder, clips=CLIPS, drop=""):
    (folder / "info").mkdir(parents=True)
    (folder / "info" / "names.txt").write_text("\n".join(clips) + "\n")
    classes = ["punching", "standing-on_one leg", "hand-waving"]
    (folder / "info" / "action_classes.txt").write_text("\n".join(classes) + "\n")
    frames = [motion.frames - 2 for motion in clips.values()]
    (folder / "info" / "num_frames_min.txt").write_text("\n".join(map(str, frames)) + "\n")
    vibe = [vibe_of(motion) for motion in clips.values()]
    data = {key: [v[key].astype(np.float32) for v in vibe] for key in vibe[0] if key != drop}
    data |= {"betas": [np.zeros((4, 10))] * len(clips), "frame_ids": [np.arange(4)] * len(clips)}
    (folder / "vibe_cache_refined.pkl").write_bytes(pickle.dumps(data))
    return folder


def _build(folder):
    return build_corpus(BuildConfig((), (), published=(Uestc(folder),)))


def test_clips_have_class_split_of_persons_and_the_motion(tmp_path):
    corpus = _build(write_folder(tmp_path))
    found = {c.name: (c.split, c.captions, c.frames) for c in corpus.clips}
    assert found == {
        "a0_d1_p001_c1": ("train", ("punching",), 58),
        "a2_d3_p003_c2": ("test", ("hand waving",), 58),
        "a1_d8_p002_c1": ("train", ("standing on one leg",), 58),
    }
    assert corpus.dropped == {"view without a direction": 1}
    assert (corpus.representation.name, corpus.fps) == ("root_rotations", 30.0)
    for clip, motion in zip(corpus.clips[:2], CLIPS.values(), strict=False):
        decoded = corpus.representation.decode(corpus.of(clip), corpus.fps)
        expected = motion.slice(0, 58).canonicalised().positions
        assert np.abs(decoded.positions - expected).max() < 0.01


def test_51_of_118_persons_train():
    from motiondiffuse_ros.corpus.published.uestc import TRAINING_PERSONS

    assert len(TRAINING_PERSONS) == 51
    assert max(TRAINING_PERSONS) <= 118


@pytest.mark.parametrize(
    "file", ["vibe_cache_refined.pkl", "info/names.txt", "info/action_classes.txt"]
)
def test_a_missing_file_is_named(tmp_path, file):
    (write_folder(tmp_path) / file).unlink()
    with pytest.raises(CorpusError, match=f"{file}: missing"):
        _build(tmp_path)


def test_poses_that_do_not_fit_are_refused(tmp_path):
    with pytest.raises(CorpusError, match=r"\.pkl: expected lists by clip under pose, joints3d"):
        _build(write_folder(tmp_path / "a", drop="orig_cam"))
    folder = write_folder(tmp_path / "b")
    names = folder / "info" / "names.txt"
    names.write_text(names.read_text() + "a0_d1_p004_c1_color.avi\n")
    with pytest.raises(CorpusError, match=r"num_frames_min\.txt has 4 lines, names\.txt 5"):
        _build(folder)
    with (folder / "info" / "num_frames_min.txt").open("a") as file:
        file.write("9\n")
    with pytest.raises(CorpusError, match=r"pose is not a list of 5"):
        _build(folder)


@pytest.mark.parametrize("name", ["walk.avi", "a9_d1_p001_c1_color.avi", "a0_d1_p200_c1_color.avi"])
def test_an_unknown_name_is_refused(tmp_path, name):
    folder = write_folder(tmp_path, {**CLIPS, name: standing(60, 30.0)})
    with pytest.raises(CorpusError, match=rf"names\.txt: '{name}' is"):
        _build(folder)


def test_a_pickle_that_calls_something_is_refused(tmp_path):
    folder = write_folder(tmp_path)
    (folder / "vibe_cache_refined.pkl").write_bytes(b"cos\nsystem\n(S'true'\ntR.")
    with pytest.raises(CorpusError, match=r"os\.system; only numpy arrays"):
        _build(folder)
