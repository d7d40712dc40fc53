"""The denoiser laid out for sampling predicts what the denoiser does."""

from dataclasses import replace

import pytest
import torch
from small_denoiser import SMALL

from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.prepared import prepared

LENGTHS = torch.tensor([60, 33, 18])
STEP = 700
INSIDE = (torch.arange(60)[None] < LENGTHS[:, None])[..., None]


def _filled(model: Denoiser) -> Denoiser:
    """Give every weight and bias a say, norms too."""
    with torch.no_grad():
        for p in model.parameters():
            p += 0.1 * torch.randn_like(p)
    return model.eval()


def _predict(model: Denoiser, dtype: torch.dtype, x, conditioning):
    ready = prepared(model, dtype)
    (styles,) = ready.styles([STEP], conditioning.pooled)
    contexts = [context.to(dtype) for context in conditioning.contexts]
    return INSIDE * ready(x, LENGTHS, contexts, styles)


def _inputs(model: Denoiser):
    torch.manual_seed(1)
    mask = torch.arange(7)[None] < torch.tensor([7, 4, 2])[:, None]
    conditioning = model.condition(torch.randn(3, 7, SMALL.text_dim), mask)
    return torch.randn(3, 60, SMALL.feature_dim), conditioning


@pytest.mark.parametrize("head_width", [16, 0])
@pytest.mark.parametrize("attention", ["efficient", "full"])
@torch.no_grad()
def test_it_predicts_the_same(head_width: int, attention: str):
    torch.manual_seed(0)
    model = _filled(Denoiser(replace(SMALL, head_width=head_width, attention=attention)))
    x, conditioning = _inputs(model)
    expected = INSIDE * model(x, torch.full((3,), STEP), LENGTHS, conditioning)
    exact = _predict(model, torch.float32, x, conditioning)
    torch.testing.assert_close(exact, expected, rtol=1e-4, atol=1e-4)
    rough = _predict(model, torch.bfloat16, x, conditioning)
    assert (rough - expected).std() < 0.03 * expected.std()


@torch.no_grad()
def test_it_follows_weights_that_change(denoiser: Denoiser):
    x, conditioning = _inputs(denoiser)
    before = _predict(denoiser, torch.float32, x, conditioning)
    kept = prepared(denoiser, torch.float32)
    assert prepared(denoiser, torch.float32) is kept
    _filled(denoiser)
    assert not torch.allclose(_predict(denoiser, torch.float32, x, conditioning), before)
