"""Weights that need few steps, beside those that taught them."""

import json
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
import torch

from motiondiffuse_ros.diffusion.checkpoint import FEW_STEPS_FILE, Checkpoint
from motiondiffuse_ros.diffusion.few_steps import FewSteps, FewStepsOf
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import CheckpointError
from motiondiffuse_ros.manifest import CONFIG_FILE
from motiondiffuse_ros.text import load_text_encoder

OF = FewStepsOf((999, 900), (300,))
PLAIN = SamplerConfig(precision="fp32")


@pytest.fixture
def folder(checkpoint, tmp_path):
    student = deepcopy(checkpoint.denoiser)
    with torch.no_grad():
        student.head.out.bias.add_(0.5)
    encoder = load_text_encoder("minilm")
    taught = replace(
        checkpoint,
        text_encoder_sha256=encoder.sha256,
        few_steps=FewSteps(lambda: student, OF),
    )
    taught.save_pretrained(tmp_path / "weights")
    return tmp_path / "weights"


@pytest.fixture
def pipeline(folder):
    return MotionPipeline.from_pretrained(folder)


def test_they_are_used_where_as_many_are_asked_for(folder, pipeline):
    few = Checkpoint.from_pretrained(folder).few_steps
    assert few.stand_for == OF
    for same in (PLAIN, replace(PLAIN, planted_below=0.0)):
        assert pipeline.few_steps(same) == OF.steps == 3
        assert pipeline.few_steps_sha256(same) == ""
        same = replace(same, steps=3)
        assert pipeline.few_steps_sha256(same) == few.sha256 != pipeline.weights_sha256
    for other in (
        replace(PLAIN, guidance_scale=2.0),
        replace(PLAIN, scheduler="ddpm"),
        replace(PLAIN, spacing=1.0),
        replace(PLAIN, guidance_interval=(0.5, 1.0)),
    ):
        assert pipeline.few_steps(other) is None
        assert pipeline.few_steps_sha256(replace(other, steps=3)) == ""


def test_what_they_do_first_shows(pipeline, checkpoint):
    def rotations(pipeline, steps=3):
        config = replace(PLAIN, steps=steps)
        return pipeline.batch(["a person walks"], [30], config=config, seed=0)[0].rotations

    encoder = load_text_encoder("minilm")
    base = MotionPipeline(replace(checkpoint, text_encoder_sha256=encoder.sha256), encoder)
    assert not np.allclose(rotations(pipeline), rotations(base), atol=1e-3)
    # what is stored in half precision
    np.testing.assert_allclose(rotations(pipeline, 4), rotations(base, 4), atol=0.05)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda c: c["files"].pop(FEW_STEPS_FILE), "without a few_steps.safetensors"),
        (lambda c: c["few_steps"].pop("taught"), "few steps of a checkpoint need"),
        (lambda c: c["few_steps"].update(wings=2), "few steps of a checkpoint need"),
        (lambda c: c["few_steps"].update(scheduler="magic"), "schedulers are"),
        (lambda c: c["few_steps"].update(guidance_interval=3), "few steps of a checkpoint"),
        (lambda c: c["few_steps"].update(taught=[999, 200]), "falling"),
        (lambda c: c["few_steps"].update(then=[]), "some that were taught and some"),
        (lambda c: c["few_steps"].update(then=["many"]), "few steps of a checkpoint"),
    ],
)
def test_spoilt_ones_are_refused_with_the_reason(folder, change, says):
    config = json.loads((folder / CONFIG_FILE).read_text())
    change(config)
    (folder / CONFIG_FILE).write_text(json.dumps(config))
    with pytest.raises(CheckpointError, match=says):
        Checkpoint.from_pretrained(folder)


def test_an_altered_file_is_refused(folder):
    (folder / FEW_STEPS_FILE).write_bytes(b"no tensors")
    with pytest.raises(CheckpointError, match="is truncated or altered"):
        Checkpoint.from_pretrained(folder)
