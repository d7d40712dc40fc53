import numpy as np
import pytest
from hypothesis import given, settings
from synthetic import smooth_motions, waving

from motiondiffuse_ros.corpus import load_motion
from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion.bvh import read_bvh, write_bvh


@settings(deadline=None, max_examples=25)
@given(smooth_motions())
def test_what_is_written_is_read_back(tmp_path_factory, motion):
    path = tmp_path_factory.mktemp("bvh") / "m.bvh"
    write_bvh(motion, path)
    loaded = load_motion(path)
    np.testing.assert_allclose(loaded.positions, motion.positions, atol=1e-4)
    assert loaded.fps == pytest.approx(motion.fps, rel=1e-5)


def test_real_files_have_their_joints_and_rates(real_paths):
    for path in real_paths:
        clip = read_bvh(path)
        assert len(clip.names) in (21, 22)
        rates = (12, 24) if "cmu" in str(path) else (30,)
        assert any(1.0 / clip.frame_time == pytest.approx(rate, rel=1e-3) for rate in rates)
        assert np.isfinite(clip.positions).all()


@pytest.fixture
def good(tmp_path):
    path = tmp_path / "good.bvh"
    write_bvh(waving(5), path)
    return path


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda text: text[: len(text) * 9 // 10], "truncated"),
        (lambda text: text.replace("HIERARCHY", "HIERARCH"), "not a BVH"),
        (lambda text: text.replace("MOTION", "MOTIO"), "not a BVH"),
        (lambda text: text.replace("}", "", 1), "brace|hierarchy"),
        (lambda text: text.replace("Frames: 5", "Frames: five"), "Frames"),
        (lambda text: text.replace("Frame Time: 0.05", "Frame Time: -0.05"), "not positive"),
        (lambda text: text.replace("OFFSET 0.000000", "OFFSET zero", 1), "hierarchy is broken"),
        (lambda text: text.rsplit(" ", 1)[0] + " nan\n", "not finite"),
        (lambda text: text.rsplit(" ", 1)[0] + " spam\n", "not numbers"),
        (lambda text: text.replace("Zrotation", "Wrotation", 1), "unknown channels"),
        (lambda text: text.replace("left_hip", "pelvis", 1), "twice"),
    ],
)
def test_broken_files_are_refused_by_name_and_reason(good, change, says):
    good.write_text(change(good.read_text()))
    with pytest.raises(MotionFileError, match=says) as caught:
        read_bvh(good)
    assert "good.bvh" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_file_is_refused(tmp_path):
    with pytest.raises(MotionFileError, match="cannot be read"):
        read_bvh(tmp_path / "none.bvh")
