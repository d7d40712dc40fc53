"""`motiondiffuse check` on files: ours, other people's, and broken ones."""

import json

import numpy as np
import pytest
from synthetic import moved, waving

from motiondiffuse_ros.cli.main import main
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.bvh import write_bvh


@pytest.fixture
def hovering(tmp_path):
    path = tmp_path / "hovering.npz"
    moved(waving(40), np.array([0.0, 0.0, 0.1])).save_npz(path)
    return path


@pytest.mark.parametrize("suffix", [".npz", ".bvh"])
def test_our_own_files_are_judged(tmp_path, capsys, suffix):
    path = tmp_path / f"motion{suffix}"
    if suffix == ".npz":
        waving(40).save_npz(path)
    else:
        write_bvh(waving(40), path)
    out = tmp_path / "new" / "report.json"
    assert main(["check", str(path), "--out", str(out), "--strict"]) == 0
    report = json.loads(out.read_text())
    assert report["verdict"] == "plausible"
    assert report["metrics"]["time_to_fall_s"] == pytest.approx(waving(40).duration, abs=0.01)
    assert "plausible (score" in capsys.readouterr().out


def test_an_implausible_file_is_no_failure_unless_strict(hovering, capsys):
    assert main(["check", str(hovering), "--no-pd"]) == 0
    assert "weight is carried by nothing" in capsys.readouterr().out
    assert main(["check", str(hovering), "--no-pd", "--strict"]) == 1


def test_a_tracked_file_leaves_the_executed_motion_and_its_film(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MUJOCO_GL", "nonsense")
    waving(9).save_npz(tmp_path / "wave.npz")
    assert (
        main(["check", "wave.npz", "--no-pd", "--track", "--threads", "1", "--out", "r.json"]) == 0
    )
    metrics = json.loads((tmp_path / "r.json").read_text())["metrics"]
    assert metrics["execution_success"] == 1.0
    assert metrics["time_to_fall_s"] is None
    folder = tmp_path / "wave_executed"
    executed = Motion.load_npz(folder / "executed.npz")
    assert executed.frames == 9
    assert np.abs(executed.positions - waving(9).positions).max() < 0.1
    with np.load(folder / "forces.npz") as forces:
        assert forces["torques"].shape == (len(forces["qpos"]), len(forces["hinge_names"]))
        assert forces["contact_forces"].shape[1:] == (len(forces["joint_names"]), 3)
    assert json.loads((folder / "execution.json").read_text())["success"] is True
    assert (folder / "executed.bvh").is_file()
    assert (folder / "tracking.gif").is_file()
    assert "wave_executed" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("gone.bvh", None, "no such file"),
        ("text.txt", b"hello", "a motion is a .bvh or a .npz file"),
        ("broken.bvh", b"HIERARCHY\nROOT Hips\n{", "broken.bvh"),
        ("empty.bvh", b"", "empty.bvh"),
        ("broken.npz", b"PK\x03\x04", "not a motion archive"),
    ],
)
def test_a_broken_file_is_one_line_and_code_two(tmp_path, capsys, name, content, words):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    assert main(["check", str(path)]) == 2
    errors = capsys.readouterr().err.strip().splitlines()
    assert len(errors) == 1
    assert words in errors[0]


def test_an_unknown_robot_lists_the_known_ones(hovering, capsys):
    assert main(["check", str(hovering), "--robot", "atlas"]) == 2
    assert "the robots are g1, humanoid" in capsys.readouterr().err
