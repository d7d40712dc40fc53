"""Products of a network with frozen weights, laid out once for the processor."""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional as F

from motiondiffuse_ros.diffusion.precision import has_bf16_products

PLAIN, GELU = "none", "gelu"


class Product:
    """x · weightᵀ + bias, and what follows it.

    oneDNN reorders the weights of a bfloat16 product every time it is asked for one. Here they are
    reordered once, where this torch can do so (the operations are those of its own compiler): same
    results, a quarter less time on products as small as ours.
    """

    def __init__(self, weight: Tensor, bias: Tensor, dtype: torch.dtype) -> None:
        """Copy weight [N, K] and bias [N] in the arithmetic of the product."""
        self._weight, self._bias = weight.detach().to(dtype), bias.detach().to(dtype)
        self._packed = _packed(self._weight)

    def __call__(self, x: Tensor, then: str = PLAIN) -> Tensor:
        """Return [..., N] of x [..., K].

        Args:
            x: In the arithmetic of the product.
            then: What is done to the result: PLAIN or GELU.
        """
        if self._packed is not None:
            return torch.ops.mkldnn._linear_pointwise(
                x, self._packed, self._bias, then, [], PLAIN if then == GELU else ""
            )
        y = F.linear(x, self._weight, self._bias)
        return F.gelu(y) if then == GELU else y


class Convolution:
    """A convolution over time with zeros beyond both ends, as one product."""

    def __init__(self, weight: Tensor, bias: Tensor, dtype: torch.dtype) -> None:
        """Copy weight [N, C, taps], their count odd, and bias [N]."""
        self._reach = weight.shape[2] // 2
        self._product = Product(weight.transpose(1, 2).flatten(1), bias, dtype)

    def __call__(self, x: Tensor) -> Tensor:
        """Return [B, T, N] of x [B, T, C]."""
        size = x.shape[1]
        wide = F.pad(x, (0, 0, self._reach, self._reach))
        taps = [wide[:, tap : tap + size] for tap in range(2 * self._reach + 1)]
        return self._product(torch.cat(taps, dim=-1))


def _packed(weight: Tensor) -> Tensor | None:
    """Return the weights in oneDNN's own order; None where that cannot be had or is of no use."""
    operations = torch.ops.mkldnn
    known = all(hasattr(operations, n) for n in ("_linear_pointwise", "_reorder_linear_weight"))
    wanted = weight.dtype == torch.bfloat16 and weight.device.type == "cpu"
    if not (wanted and known and has_bf16_products()):
        return None
    return operations._reorder_linear_weight(weight.contiguous())
