"""`motiondiffuse demo` from a terminal: real processes, real files, with and without GL."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.robots.simulation import ExecutedMotion


def motiondiffuse(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(Path(sys.executable).with_name("motiondiffuse")), *arguments],
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
    )


@pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)
def test_it_leaves_plan_report_trajectory_and_picture_even_without_gl(graph):
    out = graph / "out"
    quick = ("--seconds", "1.5", "--steps", "6", "--candidates", "1")
    run = motiondiffuse("demo", *quick, "--out", str(out), MUJOCO_GL="disable")
    assert run.returncode == 0, run.stdout + run.stderr

    plan = json.loads((out / "plan.json").read_text())
    assert len(plan["joint_names"]) == 63
    assert plan["seed"] == 7
    report = json.loads((out / "report.json").read_text())
    assert report["verdict"] in ("plausible", "marginal", "implausible")
    rows = np.genfromtxt(out / "trajectory.csv", delimiter=",", names=True)
    assert len(rows.dtype.names or ()) == 1 + 2 * 63
    assert Motion.load_npz(out / "motion.npz").frames > 20
    executed = ExecutedMotion.load_npz(out / "executed.npz")
    assert np.isfinite(executed.qpos).all()
    with Image.open(out / "demo.gif") as picture:
        assert getattr(picture, "n_frames", 1) > 10
    for log in ("node.log", "sim.log"):
        assert "Traceback" not in (out / "log" / log).read_text()


def test_bad_input_is_refused_before_anything_starts(graph):
    out = graph / "out"
    run = motiondiffuse("demo", "  ", "--out", str(out))
    assert run.returncode == 2
    assert "the text is empty" in run.stderr
    assert "Traceback" not in run.stderr
    assert not out.exists()


def test_a_missing_checkpoint_is_named_in_one_line(graph):
    missing = graph / "nowhere"
    run = motiondiffuse("demo", "--weights", str(missing), "--out", str(graph / "out"))
    assert run.returncode == 2
    assert str(missing) in run.stderr
    assert "Traceback" not in run.stderr


@pytest.mark.parametrize("command", ["node", "sim"])
def test_node_commands_explain_their_parameters(command):
    run = motiondiffuse(command, "--help")
    assert run.returncode == 0
    assert "robot" in run.stdout
    assert "default" in run.stdout


def test_an_argument_that_is_not_ros_is_refused():
    run = motiondiffuse("node", "--steps", "3")
    assert run.returncode == 2
    assert "--ros-args" in run.stderr
