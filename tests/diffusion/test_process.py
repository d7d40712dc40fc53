from itertools import pairwise

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from small_denoiser import SMALL

from motiondiffuse_ros.diffusion.process import (
    denoising_steps,
    from_clean,
    make_scheduler,
    to_clean,
)


@pytest.mark.parametrize("kind", ["sample", "epsilon", "v_prediction"])
def test_every_prediction_stands_for_the_clean_features(kind):
    generator = torch.Generator().manual_seed(0)
    clean, noise = torch.randn(2, 3, 8, 269, generator=generator)
    steps = torch.tensor([10, 500, 900])
    scheduler = make_scheduler("ddpm", SMALL)
    noisy = scheduler.add_noise(clean, noise, steps)
    alpha = scheduler.alphas_cumprod[steps][:, None, None]
    answer = {
        "sample": clean,
        "epsilon": noise,
        "v_prediction": alpha.sqrt() * noise - (1 - alpha).sqrt() * clean,
    }[kind]
    torch.testing.assert_close(to_clean(kind, answer, noisy, alpha), clean, atol=1e-4, rtol=1e-4)
    torch.testing.assert_close(from_clean(kind, clean, noisy, alpha), answer, atol=1e-3, rtol=1e-3)


@given(st.integers(1, 1000), st.floats(1.0, 5.0))
def test_denoising_starts_at_pure_noise_and_never_repeats_a_step(count, spacing):
    steps = denoising_steps(count, spacing, 1000)
    assert len(steps) == count
    assert steps[0] == 999
    assert steps[-1] >= 0
    assert all(a > b for a, b in pairwise(steps))


def test_denoising_is_denser_where_there_is_more_noise():
    assert denoising_steps(4, 1.0, 1000) == [999, 749, 499, 249]
    assert denoising_steps(4, 2.0, 1000) == [999, 937, 749, 437]
    assert denoising_steps(1000, 2.0, 1000) == list(range(999, -1, -1))
