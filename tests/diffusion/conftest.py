"""The small denoiser, with random weights."""

from __future__ import annotations

import numpy as np
import pytest
from small_denoiser import SMALL, small_denoiser

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.denoiser import Denoiser


@pytest.fixture
def denoiser() -> Denoiser:
    """Return one whose texts matter."""
    return small_denoiser()


@pytest.fixture
def checkpoint(denoiser: Denoiser) -> Checkpoint:
    """The small denoiser with unit statistics."""
    dim = SMALL.feature_dim
    return Checkpoint(denoiser, Statistics(np.zeros(dim, "f"), np.ones(dim, "f")), "0" * 64)
