"""Windows that are denoised apart, then together, by a predictor of which everything is known."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from small_denoiser import SMALL

from motiondiffuse_ros.diffusion.composition import TimedText, Window, compose
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.sampler import sample
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.motion.features import PoseState

STATE = PoseState()
FRAMES = 60
CONFIG = SamplerConfig(steps=4, spacing=1.0, guidance_scale=1.0, precision="fp32")
ON_PARTS = (
    TimedText("walk", 0, FRAMES),
    TimedText("wave", 0, FRAMES, ("right_arm",)),
)
IN_TIME = (TimedText("walk", 0, 30), TimedText("run", 30, FRAMES))


@pytest.fixture(scope="module")
def denoiser():
    torch.manual_seed(0)
    made = Denoiser(SMALL).eval()
    # a fresh denoiser predicts zeros, whatever it is told
    for parameter in made.parameters():
        torch.nn.init.normal_(parameter, std=0.1)
    return made


def _sample(denoiser, windows, seeds, **changes):
    states = torch.stack(
        [torch.randn(4, SMALL.text_dim, generator=torch.Generator().manual_seed(s)) for s in seeds]
    )
    with torch.inference_mode():
        every = denoiser.condition(states, torch.ones(len(seeds), 4, dtype=torch.bool))
    count = len(windows)
    return sample(
        denoiser,
        windows,
        every.expand(torch.arange(count)),
        every.expand(torch.tensor([0])),
        replace(CONFIG, **changes),
        frames=FRAMES,
        candidates=2,
        seed=5,
    ).features


def _windows(texts):
    return compose(texts, FRAMES, STATE, max_frames=64, blend_frames=10)


@pytest.mark.parametrize("scheduler", ["ddim", "dpm-solver++"])
def test_always_apart_gives_each_part_what_its_text_alone_would(denoiser, scheduler):
    windows = _windows(ON_PARTS)
    together = _sample(denoiser, windows, (1, 2), scheduler=scheduler, apart_above=1.0)
    apart = _sample(denoiser, windows, (1, 2), scheduler=scheduler, apart_above=0.0)
    order = {w.text: i for i, w in enumerate(windows)}
    arm = STATE.part_indices("right_arm")
    legs = STATE.part_indices("legs")
    for text, own in (("wave", arm), ("walk", legs)):
        seed = (1, 2)[order[text]]
        whole = (Window(text, 0, np.ones((FRAMES, STATE.dim))),)
        alone = _sample(denoiser, whole, (seed,), scheduler=scheduler)
        tolerance = 1e-3 if scheduler == "ddim" else 0.2
        error = (apart - alone)[:, :, own].abs().max()
        assert error < tolerance
        assert error < 0.5 * (together - alone)[:, :, own].abs().max()


def test_never_apart_is_plain_masking_to_the_bit(denoiser):
    windows = _windows(ON_PARTS)
    plain = _sample(denoiser, windows, (1, 2), apart_above=1.0)
    # a level that no step lies above
    assert torch.equal(plain, _sample(denoiser, windows, (1, 2), apart_above=0.9995))
    assert not torch.equal(plain, _sample(denoiser, windows, (1, 2), apart_above=0.5))


def test_neighbours_in_time_are_not_torn_apart(denoiser):
    windows = _windows(IN_TIME)
    assert torch.equal(
        _sample(denoiser, windows, (1, 2)), _sample(denoiser, windows, (1, 2), apart_above=0.0)
    )


@pytest.mark.parametrize("kind", ["sample", "epsilon", "v_prediction"])
def test_every_kind_of_prediction_can_be_denoised_apart(kind):
    torch.manual_seed(0)
    made = Denoiser(replace(SMALL, prediction_type=kind)).eval()
    assert torch.isfinite(_sample(made, _windows(ON_PARTS), (1, 2), apart_above=0.3)).all()
