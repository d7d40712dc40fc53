import numpy as np
import pytest
from synthetic import waving

from motiondiffuse_ros.corpus import load_motion
from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion.bvh import write_bvh


def _load(clips, name):
    return load_motion(next(clips.rglob(f"{name}.bvh"))).canonicalised()


def test_walkers_walk_ahead_upright_on_the_floor(real_clips):
    for name in ("02_01", "dataset-2_run_normal_001"):
        motion = _load(real_clips, name)
        assert motion.root[-1, 0] > 2.0
        assert 0.8 < np.median(motion.root[:, 2]) < 1.0
        assert np.median(motion.joint("head")[:, 2]) > 1.35
        lowest = motion.positions[..., 2].min(axis=1)
        assert abs(np.percentile(lowest, 10)) < 0.05


def test_left_is_left(real_clips):
    raised = _load(real_clips, "dataset-2_raise-up-left-hand_normal_001")
    assert raised.joint("left_wrist")[:, 2].max() > raised.joint("left_shoulder")[:, 2].max()
    assert (raised.joint("right_wrist")[:, 2] < raised.joint("right_shoulder")[:, 2]).all()
    assert _load(real_clips, "dataset-1_walk-left_normal_001").root[-1, 1] > 0.5
    assert _load(real_clips, "dataset-2_walk-turn-right_normal_001").heading[-1] < -0.5


def test_bow_lowers_the_head_and_comes_up(real_clips):
    head = _load(real_clips, "dataset-1_bow_active_001").joint("head")[:, 2]
    assert head[0] - head.min() > 0.3
    assert abs(head[-1] - head[0]) < 0.1


def test_unknown_skeleton_lists_the_known_maps(tmp_path):
    path = tmp_path / "odd.bvh"
    write_bvh(waving(3), path)
    path.write_text(path.read_text().replace("spine2", "backbone"))
    with pytest.raises(MotionFileError, match=r"bandai_namco.*cmu"):
        load_motion(path)
