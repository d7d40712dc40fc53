import numpy as np
import pytest
import torch

from motiondiffuse_ros.diffusion.composition import Window
from motiondiffuse_ros.diffusion.process import SCHEDULERS
from motiondiffuse_ros.diffusion.sampler import SamplerConfig, sample
from motiondiffuse_ros.errors import Cancelled, RequestError, SamplingError


def _sample(denoiser, *, windows=None, frames=40, candidates=2, seed=0, steps=4, **settings):
    callbacks = {k: settings.pop(k) for k in ("on_step", "cancelled") if k in settings}
    dim = denoiser.config.feature_dim
    windows = windows or [Window("a", 0, np.ones((frames, dim)))]
    generator = torch.Generator().manual_seed(3)
    states = torch.randn(len(windows) + 1, 5, denoiser.config.text_dim, generator=generator)
    with torch.inference_mode():
        every = denoiser.condition(states, torch.ones(states.shape[:2], dtype=torch.bool))
    return sample(
        denoiser,
        windows,
        every.expand(torch.arange(len(windows))),
        every.expand(torch.tensor([len(windows)])),
        SamplerConfig(steps=steps, bf16=False, **settings),
        frames=frames,
        candidates=candidates,
        seed=seed,
        **callbacks,
    )


@pytest.mark.parametrize("scheduler", SCHEDULERS)
def test_the_seed_decides(denoiser, scheduler):
    a, b = _sample(denoiser, scheduler=scheduler), _sample(denoiser, scheduler=scheduler)
    assert torch.equal(a, b)
    assert a.shape == (2, 40, denoiser.config.feature_dim)
    assert not torch.equal(a[0], a[1])
    assert not torch.equal(a, _sample(denoiser, scheduler=scheduler, seed=1))


def test_two_half_weights_of_one_text_are_one_window(denoiser):
    dim = denoiser.config.feature_dim
    half = np.full((40, dim), 0.5)
    states_equal = [Window("a", 0, half), Window("a", 0, half)]
    torch.manual_seed(0)
    states = torch.randn(1, 5, denoiser.config.text_dim)
    mask = torch.ones(1, 5, dtype=torch.bool)
    with torch.inference_mode():
        text = denoiser.condition(states, mask)
    settings = {"frames": 40, "candidates": 1, "seed": 0}
    config = SamplerConfig(steps=3, bf16=False)
    one = sample(denoiser, [Window("a", 0, np.ones((40, dim)))], text, text, config, **settings)
    two = sample(
        denoiser, states_equal, text.expand(torch.tensor([0, 0])), text, config, **settings
    )
    torch.testing.assert_close(one, two, atol=1e-4, rtol=1e-4)


def test_cancel_is_asked_before_every_step(denoiser):
    seen = []
    with pytest.raises(Cancelled):
        _sample(
            denoiser,
            steps=8,
            on_step=lambda done, total: seen.append((done, total)),
            cancelled=lambda: len(seen) == 3,
        )
    assert seen == [(1, 8), (2, 8), (3, 8)]


def test_values_that_are_not_finite_are_an_error(denoiser):
    with torch.no_grad():
        denoiser.head.out.bias.fill_(float("nan"))
    with pytest.raises(SamplingError, match="not finite"):
        _sample(denoiser)


def test_unknown_scheduler_lists_the_known(denoiser):
    with pytest.raises(RequestError, match=r"ddim, ddpm, dpm-solver\+\+"):
        _sample(denoiser, scheduler="euler")
