"""The command line as a user calls it: processes, exit codes, one clear line."""

import json
import subprocess
import sys

import pytest


def _run(*arguments, cwd):
    return subprocess.run(
        [sys.executable, "-m", "motiondiffuse_ros.cli.main", *map(str, arguments)],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["generate", ""], "the text is empty"),
        (["generate"], "either a text or --request"),
        (["generate", "walk", "--seconds", "nan"], "finite"),
        (["generate", "walk", "--seconds", "-3"], "times are finite and from 0"),
        (["generate", "walk", "--seconds", "9999"], "longest motion is 600"),
        (["generate", "walk", "--robot", "toaster"], "the robots are g1, humanoid"),
        (["generate", "walk", "--weights", "nowhere"], "checkpoint nowhere"),
        (["generate", "walk", "--request", "r.yaml"], "either a text or --request"),
        (["generate", "--request", "none.yaml"], "cannot be read"),
        (["generate", "walk", "--scheduler", "euler"], "ddim, ddpm"),
        (["generate", "walk", "--waypoints", "1,2"], "write TIME,X,Y"),
        (["generate", "walk", "--waypoints", "1,9,0"], "waypoint 1: needs 9.0 m/s"),
        (["generate", "wave", "--regenerate", "head"], "go with --edit"),
        (["generate", "wave", "--edit", "none.npz", "--regenerate", "head"], "no such file"),
        (["generate", "wave", "--edit", "a.npz", "--keep-frames", "soon"], "a.npz: no such file"),
        (["check", "none.bvh"], "none.bvh"),
        (["corpus", "build", "--cmu", "nowhere"], "not a folder"),
        (["corpus", "build"], "--cmu"),
        (["corpus", "fetch", "moon"], "cmu, bandai-namco"),
        (["corpus"], "build or fetch"),
        (["train", "--corpus", "nowhere"], "corpus build"),
        (["train", "--paper"], "--text-encoder"),
        (["juggle"], "the commands are generate"),
    ],
)
def test_bad_input_ends_with_2_and_one_clear_line(arguments, says, tmp_path):
    result = _run(*arguments, cwd=tmp_path)
    assert result.returncode == 2, result.stderr
    (line,) = result.stderr.strip().splitlines()
    assert says in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [["--help"], ["generate", "--help"], ["train", "--help"]])
def test_help_is_no_error(arguments, tmp_path):
    result = _run(*arguments, cwd=tmp_path)
    assert result.returncode == 0
    assert "usage" in result.stdout.lower()


def test_generate_then_check(tmp_path):
    request = tmp_path / "request.yaml"
    request.write_text(
        "duration: 3.0\nseed: 7\nsegments:\n"
        "  - {text: a person walks in a circle, start: 0.0, end: 3.0}\n"
        "  - {text: waves the right hand, start: 1.0, end: 2.5, parts: [right_arm]}\n"
    )
    made = _run(
        *("generate", "--request", request, "--steps", 4, "--candidates", 1),
        *("--no-track", "--out", "out"),
        cwd=tmp_path,
    )
    assert made.returncode == 0, made.stderr
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        *("plan.json", "report.json", "motion.bvh", "motion.npz"),
        *("trajectory.csv", "root.csv", "tracking.csv", "tracking.npz", "motion.gif"),
    }
    checked = _run("check", "out/motion.bvh", "--out", "again.json", cwd=tmp_path)
    assert checked.returncode == 0, checked.stderr
    verdict = json.loads((tmp_path / "again.json").read_text())["verdict"]
    assert verdict in ("plausible", "marginal", "implausible")


def test_a_generated_motion_can_be_edited(tmp_path):
    quick = ("--steps", 4, "--candidates", 1, "--no-track", "--no-picture")
    first = _run("generate", "a person walks", "--seconds", 2, *quick, "--out", "a", cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    again = _run(
        *("generate", "a person raises the left arm", "--edit", "a/motion.npz"),
        *("--regenerate", "left_arm", "--keep-frames", "0-0.5", *quick, "--out", "b"),
        cwd=tmp_path,
    )
    assert again.returncode == 0, again.stderr
    plan = json.loads((tmp_path / "b" / "plan.json").read_text())
    assert plan["request"]["edit"] == {
        "motion": "a/motion.npz",
        "regenerate": ["left_arm"],
        "keep": [[0.0, 0.5]],
    }


def test_corpus_build_prints_a_summary(real_clips, tmp_path):
    result = _run(
        *("corpus", "build", "--cmu", real_clips / "cmu"),
        *("--bandai-namco", real_clips / "bandai-namco", "--out", "corpus", "--workers", 1),
        cwd=tmp_path,
    )
    assert result.returncode == 0, result.stderr
    for word in ("bandai_namco", "cmu", "hours", "captions", "train"):
        assert word in result.stdout
    assert (tmp_path / "corpus" / "corpus.json").is_file()
