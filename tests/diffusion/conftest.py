"""The small denoiser, with random weights."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from small_denoiser import SMALL

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.denoiser import Denoiser


@pytest.fixture
def denoiser() -> Denoiser:
    """Random weights; the zero-initialised projections are filled so that texts matter."""
    torch.manual_seed(0)
    model = Denoiser(SMALL).eval()
    with torch.no_grad():
        for layer in model.layers:
            for style in layer.styles:
                style.project.weight.normal_(std=0.2)
    return model


@pytest.fixture
def checkpoint(denoiser: Denoiser) -> Checkpoint:
    """The small denoiser with unit statistics."""
    dim = SMALL.feature_dim
    return Checkpoint(denoiser, Statistics(np.zeros(dim, "f"), np.ones(dim, "f")), "0" * 64)
