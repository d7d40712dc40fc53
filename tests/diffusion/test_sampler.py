from typing import Any

import numpy as np
import pytest
import torch

from motiondiffuse_ros.diffusion.composition import Window
from motiondiffuse_ros.diffusion.constraints import KeptFeatures
from motiondiffuse_ros.diffusion.process import SCHEDULERS
from motiondiffuse_ros.diffusion.sampler import sample, sample_batch
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import Cancelled, RequestError, SamplingError


def _conditioning(denoiser, texts):
    generator = torch.Generator().manual_seed(3)
    states = torch.randn(texts, 5, denoiser.config.text_dim, generator=generator)
    with torch.inference_mode():
        return denoiser.condition(states, torch.ones(states.shape[:2], dtype=torch.bool))


def _sample(denoiser, *, windows=None, frames=40, candidates=2, seed=0, steps=4, **settings):
    names = ("on_step", "cancelled", "constraints", "choose")
    callbacks = {k: settings.pop(k) for k in names if k in settings}
    dim = denoiser.config.feature_dim
    windows = windows or [Window("a", 0, np.ones((frames, dim)))]
    every = _conditioning(denoiser, len(windows) + 1)
    return sample(
        denoiser,
        windows,
        every.expand(torch.arange(len(windows))),
        every.expand(torch.tensor([len(windows)])),
        SamplerConfig(steps=steps, precision="fp32", **settings),
        frames=frames,
        candidates=candidates,
        seed=seed,
        **callbacks,
    ).features


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
    settings: dict[str, Any] = {"frames": 40, "candidates": 1, "seed": 0}
    config = SamplerConfig(steps=3, precision="fp32")
    one = sample(denoiser, [Window("a", 0, np.ones((40, dim)))], text, text, config, **settings)
    two = sample(
        denoiser, states_equal, text.expand(torch.tensor([0, 0])), text, config, **settings
    )
    torch.testing.assert_close(one.features, two.features, atol=1e-4, rtol=1e-4)


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


def test_candidates_of_a_long_timeline_come_one_after_the_other(denoiser):
    dim = denoiser.config.feature_dim
    spans = [Window(f"text {n}", 10 * n, np.ones((10, dim))) for n in range(20)]
    seen = []
    motions = _sample(
        denoiser,
        windows=spans,
        frames=200,
        candidates=3,
        on_step=lambda done, total: seen.append((done, total)),
    )
    assert seen == [(step, 12) for step in range(1, 13)]
    assert motions.shape == (3, 200, dim)
    assert all(not torch.equal(motions[a], motions[b]) for a, b in ((0, 1), (1, 2), (0, 2)))


@pytest.mark.parametrize("scheduler", ["ddim", "dpm-solver++"])
@pytest.mark.parametrize("parts", [False, True])
def test_candidates_that_go_on_become_what_they_would_have_become(denoiser, scheduler, parts):
    dim = denoiser.config.feature_dim
    upper = np.zeros((40, dim))
    upper[:, : dim // 2] = 1.0
    windows = [Window("a", 0, upper), Window("b", 0, 1.0 - upper)] if parts else None
    seen = []

    def last_two(clean):
        seen.append(clean.clone())
        return [1, 2]

    settings = {"scheduler": scheduler, "windows": windows, "candidates": 3, "steps": 6}
    every = _sample(denoiser, **settings)
    some = _sample(denoiser, choose=last_two, **settings)
    torch.testing.assert_close(some, every[1:], atol=1e-4, rtol=1e-4)
    assert [x.shape for x in seen] == [(3, 40, dim)]


def test_candidates_one_after_the_other_are_thinned_like_those_at_once(denoiser):
    dim = denoiser.config.feature_dim
    spans = [Window(f"text {n}", 10 * n, np.ones((10, dim))) for n in range(20)]
    asked, seen = [], []

    def two_highest(clean):
        asked.append(len(clean))
        heights = clean.mean(dim=(1, 2))
        return sorted(heights.argsort(descending=True)[:2].tolist())

    settings = {"windows": spans, "frames": 200, "candidates": 5, "steps": 6}
    some = _sample(
        denoiser,
        choose=two_highest,
        on_step=lambda done, total: seen.append((done, total)),
        **settings,
    )
    every = _sample(denoiser, **settings)
    assert asked == [1, 2, 3, 3, 3]
    assert len(some) == 2
    which = [[torch.allclose(a, b, atol=1e-4) for b in every].index(True) for a in some]
    assert which == sorted(set(which))
    done = [d for d, _ in seen]
    assert done == sorted(done)
    assert done[-1] == seen[-1][1] == 30


def test_values_that_are_not_finite_are_an_error(denoiser):
    with torch.no_grad():
        denoiser.head.out.bias.fill_(float("nan"))
    with pytest.raises(SamplingError, match="not finite"):
        _sample(denoiser)


def test_guidance_is_used_at_its_noise_levels_only(denoiser):
    def guided(low, high):
        # four steps are at 0.25, 0.5, 0.75 and 1 of the noise
        interval = (low, high)
        return _sample(denoiser, spacing=1.0, guidance_scale=4.0, guidance_interval=interval)

    unguided = _sample(denoiser, spacing=1.0, guidance_scale=1.0)
    assert torch.equal(guided(0.0, 0.2), unguided)
    partly, wholly = guided(0.4, 0.6), guided(0.0, 1.0)
    assert not torch.allclose(partly, unguided, atol=1e-3)
    assert not torch.allclose(partly, wholly, atol=1e-3)


@pytest.mark.parametrize("interval", [(0.5, 0.5), (-0.1, 1.0), (0.0, 1.1), (0.9, 0.1)])
def test_bad_guidance_intervals_are_refused(interval):
    with pytest.raises(RequestError, match="guidance_interval must be two rising numbers"):
        SamplerConfig(guidance_interval=interval).validate()


def test_one_text_without_constraints_is_plain_sampling(denoiser):
    conditioning = _conditioning(denoiser, 2)
    text, free = (conditioning.expand(torch.tensor([i])) for i in (0, 1))
    config = SamplerConfig(steps=4, precision="fp32")
    lengths = torch.tensor([40])
    batch = sample_batch(denoiser, lengths, text, free, config, seed=0)
    window = [Window("a", 0, np.ones((40, denoiser.config.feature_dim)))]
    alone = sample(denoiser, window, text, free, config, frames=40, candidates=1, seed=0)
    assert torch.equal(batch, alone.features)  # to the bit: there is nothing to compose


@pytest.mark.parametrize("scheduler", SCHEDULERS)
def test_constraints_hold_in_the_result_and_the_seed_still_decides(denoiser, scheduler):
    mask = torch.zeros(40, denoiser.config.feature_dim)
    mask[:10] = 1.0
    kept = KeptFeatures(torch.full_like(mask, 0.25), mask)
    a, b = (_sample(denoiser, scheduler=scheduler, constraints=[kept]) for _ in range(2))
    assert torch.equal(a, b)
    assert (a[:, :10] == 0.25).all()
    free = _sample(denoiser, scheduler=scheduler)
    assert not torch.allclose(a[:, 10:], free[:, 10:])  # the rest has taken notice


def test_unknown_scheduler_lists_the_known(denoiser):
    with pytest.raises(RequestError, match=r"ddim, ddpm, dpm-solver\+\+"):
        _sample(denoiser, scheduler="euler")
