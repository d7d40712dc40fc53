import pytest
import torch

from motiondiffuse_ros.diffusion.process import denoising_steps
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.training.noise_levels import draw_steps, noise_weight


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_the_noisiest_steps_get_their_share(share):
    steps = draw_steps(1000, 20_000, share, torch.Generator().manual_seed(0))
    assert steps.min() >= 0
    assert steps.max() <= 999
    # those drawn from all steps fall among the noisiest, too
    expected = share + (1.0 - share) * 0.15
    assert (steps >= 850).float().mean().item() == pytest.approx(expected, abs=0.015)


def test_the_noisiest_of_the_noisiest_are_drawn_as_often_as_they_are_sampled():
    steps = draw_steps(1000, 20_000, 1.0, torch.Generator().manual_seed(0))
    visited = torch.tensor(denoising_steps(24, SamplerConfig.spacing, 1000))
    visited = visited[visited >= 850]
    for level in (970, 920):
        drawn = (steps >= level).float().mean()
        assert drawn.item() == pytest.approx((visited >= level).float().mean().item(), abs=0.08)


def test_the_same_generator_draws_the_same_steps():
    one, other = (draw_steps(1000, 50, 0.5, torch.Generator().manual_seed(3)) for _ in range(2))
    assert torch.equal(one, other)


def test_weights_follow_the_signal_to_noise_ratio_within_limits():
    alpha = torch.tensor([0.999, 0.75, 0.5, 0.1])
    torch.testing.assert_close(noise_weight(alpha, 5.0), torch.tensor([5.0, 3.0, 1.0, 1.0]))
    assert (noise_weight(alpha, 1.0) == 1.0).all()
