"""`motiondiffuse check` on files: ours, other people's, and broken ones."""

import json

import numpy as np
import pytest
from synthetic import moved, waving

from motiondiffuse_ros.cli.main import main
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
    assert main(["check", str(hovering), "--no-track"]) == 0
    assert "weight is carried by nothing" in capsys.readouterr().out
    assert main(["check", str(hovering), "--no-track", "--strict"]) == 1


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
    assert "the robots are humanoid" in capsys.readouterr().err
