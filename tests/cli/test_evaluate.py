"""`train-evaluator` and `evaluate`, from folders to a table; small networks, a made corpus."""

import json

import numpy as np
import pytest
import torch
from small_denoiser import SMALL

from motiondiffuse_ros.cli import evaluate, train_evaluator
from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.errors import CheckpointError, InputError

SOURCES = ["real motion", "real training clips", "random clip", "nearest caption", "weights"]


@pytest.fixture(scope="module")
def folders(tmp_path_factory, made_corpus, evaluator, encoder):
    """A corpus, an evaluator and weights on disk."""
    root = tmp_path_factory.mktemp("evaluate")
    made_corpus.save(root / "corpus")
    evaluator.save_pretrained(root / "evaluator")
    torch.manual_seed(0)
    Checkpoint(Denoiser(SMALL), made_corpus.statistics, encoder.sha256).save_pretrained(
        root / "weights"
    )
    return root


def _arguments(root, out):
    places = {"corpus": "corpus", "evaluator": "evaluator", "weights": "weights"}
    options = {
        "steps": 2,
        "repeats": 2,
        "texts-sampled": 2,
        "samples": 2,
        "plausible-motions": 3,
    }
    return [
        *(word for name, place in places.items() for word in (f"--{name}", str(root / place))),
        *(word for name, value in options.items() for word in (f"--{name}", str(value))),
        "--out",
        str(out),
    ]


def test_every_row_is_printed_and_every_hash_recorded(folders, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    out = tmp_path / "deep" / "evaluation.json"
    assert evaluate.main(_arguments(folders, out)) == 0
    result = json.loads(out.read_text())
    for kind, figure in (("texts", "R top 3"), ("actions", "Accuracy")):
        rows = {row["name"]: row for row in result[kind]}
        assert set(SOURCES) - {"real training clips"} <= set(rows)
        assert 0.0 <= rows["weights"]["metrics"][figure][0] <= 1.0
    assert [row["name"] for row in result["texts"]] == SOURCES
    for folder, recorded in (
        ("weights", result["weights"]["sha256"]),
        ("evaluator", result["evaluator_sha256"]),
    ):
        assert (
            recorded in json.loads((folders / folder / "config.json").read_text())["files"].values()
        )
    assert result["sampler"]["steps"] == 2
    assert result["protocol"]["seed"] == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in SOURCES)


def test_weights_of_another_representation_are_refused(folders, tmp_path, encoder):
    from dataclasses import replace

    other = replace(SMALL, representation="humanml3d", feature_dim=263)
    statistics = Statistics(np.zeros(263, "f"), np.ones(263, "f"))
    Checkpoint(Denoiser(other), statistics, encoder.sha256).save_pretrained(tmp_path / "weights")
    arguments = _arguments(folders, tmp_path / "out.json")
    arguments[arguments.index("--weights") + 1] = str(tmp_path / "weights")
    with pytest.raises(CheckpointError, match="the weights speak humanml3d, the corpus"):
        evaluate.main(arguments)
    assert not (tmp_path / "out.json").exists()


def test_an_evaluator_is_trained_into_an_empty_folder(folders, tmp_path):
    out = tmp_path / "evaluator"
    corpus = ["--corpus", str(folders / "corpus"), "--out", str(out)]
    few = ["--steps", "2", "--batch-size", "4"]
    assert train_evaluator.main([*corpus, *few]) == 0
    assert json.loads((out / "training.json").read_text())["training"]["steps"] == 2
    assert (out / "config.json").is_file()
    with pytest.raises(CheckpointError, match="is not empty; choose another --out"):
        train_evaluator.main([*corpus, *few])
    with pytest.raises(InputError, match="evaluator batch_size must be at least 2"):
        train_evaluator.main([*corpus, "--batch-size", "1"])
