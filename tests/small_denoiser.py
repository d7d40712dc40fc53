"""A denoiser small enough to run in a blink, with every kind of layer."""

from dataclasses import replace
from typing import Any

import torch

from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.denoiser import Denoiser

SMALL = DenoiserConfig(
    width=32,
    layers=2,
    heads=4,
    ffn_width=32,
    head_width=16,
    time_width=32,
    text_width=32,
    text_layers=1,
    text_ffn_width=32,
    max_frames=64,
)


@torch.no_grad()
def small_denoiser(**changes: Any) -> Denoiser:
    """Return it with random weights; zero-initialised projections are filled so that texts matter.

    Args:
        changes: Fields of its configuration.
    """
    torch.manual_seed(0)
    model = Denoiser(replace(SMALL, **changes)).eval()
    for layer in model.layers:
        for style in layer.styles:
            style.project.weight.normal_(std=0.2)
    return model
