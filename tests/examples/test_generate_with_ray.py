"""The example as a user calls it; the part that needs Ray only where Ray is installed."""

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "generate_with_ray.py"
QUICK = ("--seconds", 1, "--steps", 2, "--candidates", 1, "--no-track", "--workers", 1)


def _run(*arguments, cwd):
    return subprocess.run(
        [sys.executable, str(EXAMPLE), *map(str, arguments)],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=280,
    )


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.txt", "a person walks\n!!!\n", "entry 2: segment 1: the text '!!!' has no words"),
        ("a.jsonl", '{"text": "a person walks", "speed": 2}\n', "entry 1: request: unknown field"),
        ("a.yaml", "text: a person walks\n", "must be a list"),
    ],
)
def test_a_bad_list_is_refused_before_any_work(name, content, says, tmp_path):
    (tmp_path / name).write_text(content)
    result = _run(name, cwd=tmp_path)
    assert result.returncode == 2, result.stderr
    (line,) = result.stderr.strip().splitlines()
    assert says in line
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.skipif(find_spec("ray") is not None, reason="ray is installed")
def test_without_ray_it_says_what_to_install(tmp_path):
    (tmp_path / "a.txt").write_text("a person walks\n")
    result = _run("a.txt", *QUICK, cwd=tmp_path)
    assert result.returncode == 2
    assert "pip install ray" in result.stderr


@pytest.mark.skipif(find_spec("ray") is None, reason="ray is not installed (pip install ray)")
def test_an_impossible_request_does_not_lose_the_others_and_what_is_there_is_kept(tmp_path):
    # a robot that there is not is found by the worker
    first = {"text": "a person bows", "seed": 7}
    rows = [{"text": "a person walks", "robot": "toaster"}, first]
    (tmp_path / "a.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    result = _run("a.jsonl", *QUICK, "--out", "out", cwd=tmp_path)
    assert result.returncode == 1, result.stderr
    assert "toaster" in result.stdout
    folder = tmp_path / "out" / "00001-a-person-bows"
    plan = json.loads((folder / "plan.json").read_text())
    assert plan["seed"] == 7
    assert {p.name for p in folder.parent.iterdir()} == {folder.name, "results.jsonl"}
    results = [json.loads(x) for x in (tmp_path / "out" / "results.jsonl").read_text().splitlines()]
    assert {row["folder"]: row.get("seed") for row in results} == {
        "00000-a-person-walks": None,
        "00001-a-person-bows": 7,
    }

    (tmp_path / "a.jsonl").write_text('"a person stands"\n' + json.dumps(first) + "\n")
    before = (folder / "plan.json").stat().st_mtime_ns
    again = _run("a.jsonl", *QUICK, "--out", "out", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert "1 of them finished before" in again.stdout
    assert (folder / "plan.json").stat().st_mtime_ns == before
    assert (tmp_path / "out" / "00000-a-person-stands" / "plan.json").is_file()

    other = json.dumps({**first, "seed": 8})
    (tmp_path / "a.jsonl").write_text('"a person stands"\n' + other + "\n")
    refused = _run("a.jsonl", *QUICK, "--out", "out", cwd=tmp_path)
    assert refused.returncode == 2
    assert "another seed" in refused.stderr
