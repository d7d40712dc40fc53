"""Which arithmetic the denoiser runs in."""

from __future__ import annotations

import time
from functools import cache

import torch

from motiondiffuse_ros.errors import RequestError

PRECISIONS = ("auto", "fp32", "bf16")

_TIMES_FASTER = 1.25
_ROUNDS = 5


def check_precision(name: str) -> None:
    """Raise RequestError if there is no such precision."""
    if name not in PRECISIONS:
        raise RequestError(f"unknown precision '{name}'; they are {', '.join(PRECISIONS)}")


def use_bf16(precision: str, device: torch.device | str = "cpu") -> bool:
    """Return whether to run under bfloat16 autocast.

    Processors with matrix units for bfloat16 are about three times faster in it; others have its
    instructions and are half as fast as in float32 (docs/training.md), so that "auto" goes by
    what is measured, once a process.

    Args:
        precision: One of `PRECISIONS`.
        device: Where the denoiser runs; "auto" on anything but a CPU is bfloat16.
    """
    if precision != "auto":
        return precision == "bf16"
    return torch.device(device).type != "cpu" or _bf16_is_faster()


def has_bf16_products() -> bool:
    """Return whether oneDNN multiplies bfloat16 on this processor; else one product takes 0.3 s."""
    return torch.backends.mkldnn.is_available() and torch.ops.mkldnn._is_mkldnn_bf16_supported()


@cache
def _bf16_is_faster() -> bool:
    if not has_bf16_products():
        return False
    # of the size of the denoiser's own products; the margin keeps the answer the same every time
    a, b = torch.randn(1024, 384), torch.randn(384, 1024)
    pairs = ((a, b), (a.bfloat16(), b.bfloat16()))
    best = [float("inf"), float("inf")]
    for _ in range(_ROUNDS):
        for i, (x, y) in enumerate(pairs):
            began = time.perf_counter()
            torch.mm(x, y)
            best[i] = min(best[i], time.perf_counter() - began)
    return best[0] > _TIMES_FASTER * best[1]
