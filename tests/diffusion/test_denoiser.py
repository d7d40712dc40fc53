from dataclasses import replace

import pytest
import torch
from small_denoiser import small_denoiser

from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.errors import CheckpointError


def _inputs(denoiser, batch=3, frames=30):
    generator = torch.Generator().manual_seed(1)
    dim, text_dim = denoiser.config.feature_dim, denoiser.config.text_dim
    x = torch.randn(batch, frames, dim, generator=generator)
    states = torch.randn(batch, 7, text_dim, generator=generator)
    mask = torch.ones(batch, 7, dtype=torch.bool)
    return x, torch.full((batch,), 500), states, mask


@torch.inference_mode()
def test_padding_changes_nothing(denoiser):
    x, steps, states, mask = _inputs(denoiser)
    lengths = torch.full((3,), 22)
    text = denoiser.condition(states, mask)
    short = denoiser(x[:, :22], steps, lengths, text)
    long = denoiser(x, steps, lengths, text)
    torch.testing.assert_close(short, long[:, :22], atol=1e-5, rtol=1e-4)


@torch.inference_mode()
def test_text_padding_changes_nothing(denoiser):
    x, steps, states, mask = _inputs(denoiser)
    lengths = torch.full((3,), 30)
    mask[:, 5:] = False
    cut = denoiser.condition(states[:, :5], mask[:, :5])
    padded = denoiser.condition(states, mask)
    torch.testing.assert_close(
        denoiser(x, steps, lengths, cut),
        denoiser(x, steps, lengths, padded),
        atol=1e-5,
        rtol=1e-4,
    )


@pytest.mark.parametrize("attention", ["efficient", "full"])
@pytest.mark.parametrize("alone", [5, 7, 9])
@torch.inference_mode()
def test_texts_of_other_lengths_stand_beside_each_other(attention, alone):
    denoiser = small_denoiser(attention=attention)
    x, steps, states, mask = _inputs(denoiser)
    other = torch.randn(1, alone, denoiser.config.text_dim)
    of_other = denoiser.condition(other, torch.ones(1, alone, dtype=torch.bool))
    both = denoiser.condition(states[:2], mask[:2]).beside(of_other)
    lengths = torch.full((3,), 30)
    y = denoiser(x, steps, lengths, both)
    own = denoiser(x[2:], steps[2:], lengths[2:], of_other)
    torch.testing.assert_close(y[2:], own, atol=1e-5, rtol=1e-4)
    first = denoiser(x[:2], steps[:2], lengths[:2], denoiser.condition(states[:2], mask[:2]))
    torch.testing.assert_close(y[:2], first, atol=1e-5, rtol=1e-4)


@torch.inference_mode()
def test_rows_are_independent_and_texts_and_steps_matter(denoiser):
    x, steps, states, mask = _inputs(denoiser)
    x = x[:1].expand(3, -1, -1)
    lengths = torch.full((3,), 30)
    states = torch.stack([states[0], states[0], states[1]])
    y = denoiser(x, steps, lengths, denoiser.condition(states, mask))
    torch.testing.assert_close(y[0], y[1])
    assert (y[0] - y[2]).abs().max() > 1e-3
    later = denoiser(x, steps + 300, lengths, denoiser.condition(states, mask))
    assert (y[0] - later[0]).abs().max() > 1e-3


@pytest.mark.parametrize("attention", ["efficient", "full"])
@pytest.mark.parametrize(("patch_size", "head_width"), [(1, 0), (4, 16)])
def test_every_variant_trains(denoiser, attention, patch_size, head_width):
    config = replace(
        denoiser.config, attention=attention, patch_size=patch_size, head_width=head_width
    )
    model = Denoiser(config)
    x, steps, states, mask = _inputs(model)
    y = model(x, steps, torch.tensor([30, 10, 1]), model.condition(states, mask))
    assert y.shape == x.shape
    y.square().mean().backward()
    assert all(torch.isfinite(p.grad).all() for p in model.parameters() if p.grad is not None)
    untouched = [name for name, p in model.named_parameters() if p.grad is None]
    assert untouched == []


def test_the_paper_configuration_has_the_paper_sizes():
    config = DenoiserConfig.paper()
    config.validate()
    assert (config.layers, config.width, config.ffn_width) == (8, 512, 1024)
    assert (config.text_encoder, config.text_layers, config.text_width) == ("clip", 4, 256)
    assert (config.train_steps, config.beta_start, config.beta_end) == (1000, 1e-4, 0.02)
    assert (config.patch_size, config.prediction_type) == (1, "epsilon")
    with torch.device("meta"):
        Denoiser(config)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"prediction_type": "noise"}, "epsilon, sample, v_prediction"),
        ({"heads": 5}, "multiples of their heads"),
        ({"max_frames": 63}, "multiple of patch_size"),
        ({"layers": 0}, "at least 1"),
        ({"colour": 1}, "unknown fields"),
    ],
)
def test_bad_configurations_are_refused(denoiser, change, says):
    with pytest.raises(CheckpointError, match=says):
        DenoiserConfig.from_dict({**denoiser.config.to_dict(), **change})
