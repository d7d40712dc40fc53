"""`train-evaluator` and `evaluate`, from folders to a table; small networks, a made corpus."""

import json
from dataclasses import replace

import numpy as np
import pytest
import torch
from small_denoiser import SMALL

from motiondiffuse_ros.cli import evaluate, train_evaluator
from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.corpus.store import pack_clips
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.errors import CheckpointError, InputError

SOURCES = ["real motion", "real training clips", "random clip", "nearest caption", "generated"]
KEYS = ["r_precision_top1", "r_precision_top2", "r_precision_top3", "fid", "mm_dist", "diversity"]


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
    assert list(result["rows"]) == ["real", "training", "random", "retrieval", "generated"]
    for name in ("real", "random", "retrieval", "generated"):
        row = result["rows"][name]
        for key in (*KEYS, "phys_err_mm", "skating_ratio"):
            assert set(row[key]) == {"mean", "ci95"}, (name, key)
    assert result["rows"]["real"]["multimodality"] is None
    assert result["rows"]["generated"]["multimodality"]["mean"] >= 0.0
    assert 0.0 <= result["actions"]["generated"]["accuracy"]["mean"] <= 1.0
    assert (result["clips"], result["repeats"], result["split"]) == (40, 2, "test")
    for folder in ("weights", "evaluator"):
        hashes = json.loads((folders / folder / "config.json").read_text())["files"].values()
        assert result[f"{folder}_sha256"] in hashes
    assert result["sampler"]["steps"] == 2
    assert result["protocol"]["seed"] == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in SOURCES)


def test_a_corpus_that_the_weights_have_never_seen_is_measured_whole(
    folders, tmp_path, made_corpus
):
    # clips without actions in their names, and none for training
    clips, features = pack_clips(
        [
            (f"take_{i}", c.dataset, "test", c.captions, made_corpus.of(c))
            for i, c in enumerate(made_corpus.split("test"))
        ]
    )
    replace(made_corpus, clips=clips, features=features).save(tmp_path / "new")
    out = tmp_path / "metrics.json"
    arguments = [*_arguments(folders, out), "--split", "all"]
    arguments[arguments.index("--corpus") + 1] = str(tmp_path / "new")
    assert evaluate.main(arguments) == 0
    result = json.loads(out.read_text())
    assert list(result["rows"]) == ["real", "random", "retrieval", "generated"]
    assert result["clips"] == 40
    assert result["actions"] is None


def test_weights_of_another_representation_are_refused(folders, tmp_path, encoder):
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
    again = tmp_path / "again"
    assert train_evaluator.main([*corpus[:3], str(again), *few, "--start", str(out)]) == 0
    assert json.loads((again / "training.json").read_text())["started_from"]
    first, second = ((f / "actions.safetensors").read_bytes() for f in (out, again))
    assert first == second
    first, second = ((f / "text_motion.safetensors").read_bytes() for f in (out, again))
    assert first != second
    with pytest.raises(InputError, match="evaluator batch_size must be at least 2"):
        train_evaluator.main([*corpus, "--batch-size", "1"])
