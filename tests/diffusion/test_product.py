import pytest
import torch
from torch.nn import functional as F

from motiondiffuse_ros.diffusion.product import GELU, Convolution, Product

EXACT = {torch.float32: 1e-5, torch.bfloat16: 0.03}
"""Rounding of the results, which are of the order of one."""


def _random(*shape: int, seed: int = 0) -> torch.Tensor:
    return torch.randn(shape, generator=torch.Generator().manual_seed(seed))


@pytest.mark.parametrize("dtype", EXACT)
@pytest.mark.parametrize("rows", [1, 7, 240])
def test_it_is_the_linear_layer_with_what_follows(dtype, rows):
    weight, bias, x = _random(48, 32, seed=1) / 32**0.5, _random(48, seed=2), _random(2, rows, 32)
    product = Product(weight, bias, dtype)
    expected = F.linear(x, weight, bias)
    tolerance = {"atol": EXACT[dtype], "rtol": EXACT[dtype]}
    torch.testing.assert_close(product(x.to(dtype)).float(), expected, **tolerance)
    torch.testing.assert_close(product(x.to(dtype), GELU).float(), F.gelu(expected), **tolerance)


@pytest.mark.parametrize("dtype", EXACT)
@pytest.mark.parametrize("taps", [1, 3, 5])
def test_a_convolution_is_the_one_with_zeros_beyond_both_ends(dtype, taps):
    weight, bias = _random(12, 16, taps, seed=3) / (16 * taps) ** 0.5, _random(12, seed=4)
    x = _random(3, 20, 16)
    expected = F.conv1d(x.transpose(1, 2), weight, bias, padding=taps // 2).transpose(1, 2)
    made = Convolution(weight, bias, dtype)(x.to(dtype)).float()
    torch.testing.assert_close(made, expected, atol=EXACT[dtype], rtol=EXACT[dtype])


def test_later_changes_of_the_weights_do_not_reach_it():
    weight, bias, x = _random(4, 8), _random(4), _random(1, 8)
    product = Product(weight, bias, torch.bfloat16)
    before = product(x.bfloat16())
    weight.zero_()
    assert torch.equal(product(x.bfloat16()), before)
