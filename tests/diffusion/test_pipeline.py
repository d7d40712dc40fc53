"""Many texts at once, through a small denoiser with random weights and the real text encoder."""

import numpy as np
import pytest

from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.text import load_text_encoder

CONFIG = SamplerConfig(steps=2, precision="fp32")


@pytest.fixture
def pipeline(checkpoint) -> MotionPipeline:
    encoder = load_text_encoder("minilm")
    return MotionPipeline(
        Checkpoint(checkpoint.denoiser, checkpoint.statistics, encoder.sha256), encoder
    )


def test_every_text_gets_a_motion_of_its_length_in_its_place(pipeline):
    texts = [f"a person walks in way {i}" for i in range(40)]
    frames = [20 + (7 * i) % 40 for i in range(40)]
    seen = []
    motions = pipeline.batch(
        texts, frames, config=CONFIG, seed=0, on_progress=lambda *p: seen.append(p)
    )
    assert [m.frames for m in motions] == frames
    assert seen == [(32, 40), (40, 40)]


def test_the_seed_decides_and_every_motion_has_noise_of_its_own(pipeline):
    texts, frames = ["a person walks"] * 34, [30] * 34

    def roots(seed):
        return np.array([m.root for m in pipeline.batch(texts, frames, config=CONFIG, seed=seed)])

    first = roots(0)
    assert np.array_equal(first, roots(0))
    assert not np.array_equal(first, roots(1))
    assert len(np.unique(first.reshape(34, -1), axis=0)) == 34


def test_the_text_decides(pipeline):
    one, other = (
        pipeline.batch([text], [30], config=CONFIG, seed=0)[0].root
        for text in ("a person walks forward", "a person jumps up and down")
    )
    assert not np.allclose(one, other, atol=1e-3)
