import json

import pytest
import torch

from motiondiffuse_ros.diffusion.checkpoint import MODEL_FILE, Checkpoint
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.errors import CheckpointError, TextEncoderError
from motiondiffuse_ros.manifest import CONFIG_FILE
from motiondiffuse_ros.text import load_text_encoder


@pytest.fixture
def folder(checkpoint, tmp_path):
    checkpoint.save_pretrained(tmp_path / "weights", torch.float32)
    return tmp_path / "weights"


def test_round_trip(checkpoint, folder):
    loaded = Checkpoint.from_pretrained(folder)
    assert loaded.denoiser.config == checkpoint.denoiser.config
    assert len(loaded.sha256) == 64
    for name, value in checkpoint.denoiser.state_dict().items():
        torch.testing.assert_close(loaded.denoiser.state_dict()[name], value)


def _truncate(folder):
    path = folder / MODEL_FILE
    path.write_bytes(path.read_bytes()[:-1000])


def _remove(name):
    return lambda folder: (folder / name).unlink()


def _configure(change):
    def apply(folder):
        config = json.loads((folder / CONFIG_FILE).read_text())
        change(config)
        (folder / CONFIG_FILE).write_text(json.dumps(config))

    return apply


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (_truncate, "truncated or altered"),
        (_remove(MODEL_FILE), "model.safetensors is missing"),
        (_remove("statistics.safetensors"), "statistics.safetensors is missing"),
        (_remove(CONFIG_FILE), "no config.json"),
        (lambda f: (f / CONFIG_FILE).write_text("{"), "not JSON"),
        (lambda f: (f / CONFIG_FILE).write_text("[]"), "needs"),
        (_configure(lambda c: c.update(format=99)), "format 99"),
        (_configure(lambda c: c["denoiser"].update(layers=3)), "does not fit"),
        (_configure(lambda c: c["denoiser"].update(wings=2)), "unknown fields"),
    ],
)
def test_spoilt_checkpoints_are_refused_with_the_reason(folder, spoil, says):
    spoil(folder)
    with pytest.raises(CheckpointError, match=says):
        Checkpoint.from_pretrained(folder)


def test_a_missing_folder_is_refused(tmp_path):
    with pytest.raises(CheckpointError, match="nowhere"):
        Checkpoint.from_pretrained(tmp_path / "nowhere")


def test_another_text_encoder_than_the_trained_one_is_refused(checkpoint):
    with pytest.raises(TextEncoderError, match="trained with minilm 000000"):
        MotionPipeline(checkpoint, load_text_encoder("minilm"))
