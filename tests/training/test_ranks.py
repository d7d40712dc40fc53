"""Training in two real processes over gloo, and by torchrun."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import torch
from two_ranks import gradient_of_rows, gradients, small_corpus, small_trainer

from motiondiffuse_ros.training.ranks import Ranks
from motiondiffuse_ros.training.trainer import STATE_FILE

TESTS = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What `two_ranks.py` left: the folders one/ and run/, and what each process found."""
    folder = tmp_path_factory.mktemp("ranks")
    paths = os.pathsep.join([str(TESTS), os.environ.get("PYTHONPATH", "")])
    script = str(TESTS / "two_ranks.py")
    processes = [
        subprocess.Popen(
            [sys.executable, script, str(rank), str(folder / "meeting"), str(folder)],
            env={**os.environ, "PYTHONPATH": paths},
            stderr=subprocess.PIPE,
            text=True,
        )
        for rank in range(2)
    ]
    try:
        for process in processes:
            _, errors = process.communicate(timeout=200)
            assert process.returncode == 0, errors
    finally:
        for process in processes:
            process.kill()
    return folder


@pytest.fixture(scope="module")
def found(folder):
    return [torch.load(folder / f"{rank}.pt", weights_only=True) for rank in range(2)]


def _same(got, expected):
    assert set(got) == set(expected)
    for name, value in expected.items():
        # against the largest: sums of other order leave noise in those near zero
        assert (got[name] - value).abs().max() <= 1e-3 * value.abs().max() + 1e-6, name


def test_the_gradient_is_that_of_the_joint_batch(found):
    joint = gradient_of_rows(Ranks(), slice(0, 4))
    assert all(gradient.any() for gradient in joint.values())
    for rank in range(2):
        _same(found[rank]["rows"], joint)


def test_each_draws_its_own_windows_and_steps_by_the_mean_gradient(found, tmp_path):
    alone = []
    for rank in range(2):
        # draws like one of two, and has nobody to average with
        trainer = small_trainer(tmp_path / str(rank), Ranks(rank, 1), gradient_clip=1e9)
        trainer.run()
        alone.append(gradients(trainer))
    first, second = alone
    assert any(not torch.allclose(first[name], second[name], rtol=0.1) for name in first)
    mean = {name: (first[name] + second[name]) / 2 for name in first}
    for rank in range(2):
        _same(found[rank]["gradients"], mean)


def test_both_end_with_the_same_weights_at_the_same_step_though_one_clock_runs_out(found):
    for which in ("weights", "weights again"):
        for name, value in found[0][which].items():
            assert value.equal(found[1][which][name]), name
    assert found[0]["saved"] == found[1]["saved"] > 2


def test_a_stop_in_one_ends_both_after_a_step_of_the_resumed_run(found):
    step = found[0]["saved"] + 1
    for rank in range(2):
        assert found[rank]["stop"] == f"stopped after {step} steps; go on with --resume"


def test_files_are_written_once(folder):
    run = folder / "run"
    rows = [json.loads(line) for line in (run / "log.jsonl").read_text().splitlines()]
    steps = [row["step"] for row in rows if "validation" in row]
    assert steps == sorted(set(steps))
    assert len(list(run.glob("events.out.tfevents.*"))) == 2  # the run and its resumption
    assert json.loads((run / "config.json").read_text())["processes"] == 2


def test_torchrun_trains_and_ends_with_its_state_saved_when_terminated(tmp_path):
    small_corpus().save(tmp_path / "corpus")
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "torch.distributed.run", "--standalone"),
            *("--nproc-per-node", "2", "-m", "motiondiffuse_ros.cli.main", "train"),
            *("--corpus", str(tmp_path / "corpus"), "--out", str(tmp_path / "run")),
            *("--width", "32", "--layers", "1", "--batch-size", "2", "--precision", "fp32"),
            *("--save-minutes", "1e-6", "--minutes", "100"),
        ],
        stderr=subprocess.PIPE,
        text=True,
    )
    state = tmp_path / "run" / STATE_FILE
    try:
        while not state.exists() and process.poll() is None:
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        _, errors = process.communicate(timeout=100)
    finally:
        process.kill()
    assert errors.count("motiondiffuse: interrupted") == 2, errors
    assert torch.load(state, weights_only=True)["step"] > 0
    assert json.loads((tmp_path / "run" / "config.json").read_text())["processes"] == 2
