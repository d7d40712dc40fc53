import json

import numpy as np
import pytest
from smpl_poses import smpl_poses
from synthetic import drifting, standing, waving

from motiondiffuse_ros.corpus.build import BuildConfig, build_corpus
from motiondiffuse_ros.corpus.published import Babel
from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion import rotations as rot

Z_UP = rot.from_matrix(np.eye(3)[[2, 0, 1]])  # from y up to AMASS's world
WALK = drifting(standing(480, 120.0), 1.0)
WAVE = waving(200, 100.0)


def write_motion(amass, path, motion):
    """Write a file of AMASS (SMPL+H)."""
    poses, root = smpl_poses(motion, Z_UP, 52)
    file = amass / path
    file.parent.mkdir(parents=True, exist_ok=True)
    np.savez(
        file,
        poses=poses,
        trans=root + np.array([0.4, 0.3, 0.2]),  # the pelvis is not where SMPL's translation is
        mocap_framerate=np.array(motion.fps),
        gender=np.array("female"),
        betas=np.zeros(16),
        dmpls=np.zeros((motion.frames, 8)),
    )


def label(text, category, start=None, end=None):
    times = {} if start is None else {"start_t": start, "end_t": end}
    words = {"raw_label": text, "proc_label": text.split()[0], "seg_id": "daf942ad"}
    return {**words, "act_cat": [category], **times}


def sequence(number, path, seq, frame):
    def annotation(labels):
        return labels and {"anntr_id": "a", "babel_lid": "b", "labels": labels, "mul_act": True}

    return {
        "babel_sid": number,
        "dur": 4.0,
        "feat_p": path,
        "url": f"https://babel-renders.s3.eu-central-1.amazonaws.com/{number:06}.mp4",
        "seq_ann": annotation(seq),
        "frame_ann": annotation(frame),
    }


@pytest.fixture
def folders(tmp_path):
    babel, amass = tmp_path / "babel_v1.0_release", tmp_path / "amass"
    babel.mkdir()
    walk, wave = "CMU/CMU/141/141_05_poses.npz", "MPIHDM05/MPI_HDM05/bk/HDM_bk_poses.npz"
    write_motion(amass, walk, WALK)
    write_motion(amass, "HDM05/bk/HDM_bk_poses.npz", WAVE)
    frames = [
        label("walking to the left", "walk", 0, 2),
        label("strolling", "walk", 0, 2),
        label("transition", "transition", 2, 2.2),
        label("hopping", "hop", 2.2, 2.5),
        label("standing", "stand", 2.5, 4.001),
    ]
    withheld = {"raw_label": None, "proc_label": None, "seg_id": "2970072b", "act_cat": None}
    timed = {**withheld, "start_t": 0, "end_t": 2}
    splits = {
        "train": [
            sequence(7692, walk, [label("jump", "jump")], frames),
            sequence(12, "KIT/KIT/3/gone_poses.npz", [label("run", "run")], None),
        ],
        "val": [
            sequence(31, wave, [label("wave right hand", "wave"), label("greet", "greet")], None)
        ],
        "test": [sequence(99, walk, [withheld], None), sequence(98, walk, [withheld], [timed])],
    }
    for split, sequences in splits.items():
        entries = {str(s["babel_sid"]): s for s in sequences}
        (babel / f"{split}.json").write_text(json.dumps(entries))
    return babel, amass


def _build(folders):
    return build_corpus(BuildConfig((), (), published=(Babel(*folders),)))


def test_frame_labels_are_clips_and_sequence_labels_the_rest(folders):
    corpus = _build(folders)
    found = {c.name: (c.split, c.captions, c.frames) for c in corpus.clips}
    assert found == {
        "7692_0-2": ("train", ("walking to the left", "strolling"), 60),
        "7692_2.5-4.001": ("train", ("standing",), 45),
        "31": ("val", ("wave right hand", "greet"), 60),
    }
    assert corpus.dropped == {
        "transition": 1,
        "shorter than 0.8 s": 1,
        "no motion file": 1,
        "no caption": 2,
    }
    assert (corpus.representation.name, corpus.fps) == ("root_rotations", 30.0)


def test_motions_are_those_of_amass_on_the_floor_at_30_hz(folders):
    corpus = _build(folders)
    clips = {c.name: c for c in corpus.clips}
    for name, motion in (
        ("7692_0-2", WALK.resample(30.0).slice(0, 60)),
        ("31", WAVE.resample(30.0)),
    ):
        decoded = corpus.representation.decode(corpus.of(clips[name]), corpus.fps)
        expected = motion.canonicalised().positions
        assert np.abs(decoded.positions - expected).max() < 0.01


def test_what_is_missing_is_named(folders, tmp_path):
    babel, amass = folders
    with pytest.raises(CorpusError, match=r"elsewhere: holds none of the files that BABEL names"):
        _build((babel, tmp_path / "elsewhere"))
    with pytest.raises(CorpusError, match=r"train\.json: missing"):
        _build((amass, amass))


def test_broken_files_are_named(folders):
    _, amass = folders
    file = amass / "HDM05/bk/HDM_bk_poses.npz"
    np.savez(file, poses=np.zeros((5, 156)))
    with pytest.raises(CorpusError, match=r"HDM_bk_poses\.npz: expected AMASS's poses, trans"):
        _build(folders)
    np.savez(file, poses=np.zeros((5, 63)), trans=np.zeros((5, 3)), mocap_framerate=60.0)
    with pytest.raises(CorpusError, match=r"poses: has shape \(5, 63\); expected \[T, 156\]"):
        _build(folders)
    np.savez(file, poses=np.zeros((5, 156)), trans=np.zeros((4, 3)), mocap_framerate=60.0)
    with pytest.raises(CorpusError, match=r"5 poses, 4 positions at 60\.0 Hz"):
        _build(folders)


def test_broken_labels_are_named(folders):
    babel, _ = folders
    entries = json.loads((babel / "train.json").read_text())
    del entries["7692"]["frame_ann"]["labels"][0]["end_t"]
    (babel / "train.json").write_text(json.dumps(entries))
    with pytest.raises(CorpusError, match=r"train\.json, sequence 7692: .*end_t"):
        _build(folders)
    (babel / "train.json").write_text("[1, 2]")
    with pytest.raises(CorpusError, match=r"train\.json: expected sequences by number"):
        _build(folders)
    (babel / "train.json").write_text("{")
    with pytest.raises(CorpusError, match=r"train\.json: not JSON"):
        _build(folders)
