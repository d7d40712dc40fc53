import pytest
import torch
from small_denoiser import SMALL

from motiondiffuse_ros.diffusion.process import from_clean, make_scheduler, to_clean


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
