"""`generate --record` and `replay` as a user calls them."""

import subprocess
import sys
from dataclasses import replace

import pytest

from motiondiffuse_ros.cli.main import main
from motiondiffuse_ros.manifest import shipped
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.recording import read_recording, write_recording

pytestmark = pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)


def run(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "motiondiffuse_ros.cli.main", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recording")
    made = run(
        *("generate", "a person walks", "--seconds", 2, "--steps", 3, "--candidates", 2),
        *("--no-track", "--no-picture", "--out", folder / "out", "--record", folder / "a.mcap"),
    )
    assert made.returncode == 0, made.stderr
    assert "recorded in" in made.stdout
    return folder / "a.mcap"


def test_the_same_again_is_0(recording, tmp_path):
    result = run("replay", recording, "--out", tmp_path / "again", "--no-picture")
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip().endswith("the same trajectory bit for bit")
    for name in ("trajectory.csv", "root.csv", "motion.bvh"):
        first = recording.parent / "out" / name
        assert (tmp_path / "again" / name).read_bytes() == first.read_bytes()


def test_another_trajectory_is_1_and_what_may_be_why_is_said(recording, tmp_path):
    record = read_recording(recording)
    positions = record.values["trajectory/positions"].copy()
    positions[-1] += 1e-12
    altered = replace(
        record,
        values={**record.values, "trajectory/positions": positions},
        surroundings={**record.surroundings, "numpy": "1.0"},
    )
    write_recording(tmp_path / "b.mcap", altered)
    result = run("replay", tmp_path / "b.mcap")
    assert result.returncode == 1, result.stderr
    assert "not the same trajectory: positions at 1 of" in result.stdout
    assert "warning: numpy: recorded with 1.0" in result.stderr


def test_what_cannot_be_planned_again_is_2_in_one_line(recording, tmp_path, capsys):
    half = tmp_path / "half.mcap"
    half.write_bytes(recording.read_bytes()[:5000])
    for arguments, says in (
        ((half,), "half.mcap: truncated or damaged"),
        ((tmp_path / "none.mcap",), "cannot be read"),
        ((recording, "--weights", shipped("cmu")), "is not the one that was recorded"),
    ):
        assert main(["replay", *map(str, arguments)]) == 2
        (line,) = capsys.readouterr().err.strip().splitlines()
        assert says in line
