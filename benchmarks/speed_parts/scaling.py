"""How sampling and attention grow with batch, threads and length."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import torch

from benchmarks.speed_parts.clock import median_seconds
from benchmarks.speed_parts.sampling import sample_seconds
from motiondiffuse_ros.diffusion.attention import Attention
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.planner import shipped_weights

matplotlib.use("agg")
from matplotlib import pyplot as plt

WIDTH, HEADS = 384, 8


def batch_rows(
    seconds: float, batches: Sequence[int], threads: Sequence[int], repeats: int
) -> list[dict[str, float]]:
    """Return the time to sample some candidates at once, for every number of threads."""
    pipeline = MotionPipeline.from_pretrained(shipped_weights())
    rows, before = [], torch.get_num_threads()
    for count in threads:
        torch.set_num_threads(count)
        for batch in batches:
            took = sample_seconds(pipeline, seconds, batch, repeats)
            rows.append({"threads": count, "batch": batch, "sampling_s": took})
    torch.set_num_threads(before)
    return rows


@torch.inference_mode()
def attention_rows(tokens: Sequence[int], repeats: int) -> list[dict[str, float]]:
    """Return the time of one self-attention over so many tokens, of both kinds [s]."""
    rows = []
    for count in tokens:
        x, mask = torch.randn(1, count, WIDTH), torch.ones(1, count, dtype=torch.bool)
        row = {"tokens": float(count)}
        for kind in ("efficient", "full"):
            layer = Attention(WIDTH, WIDTH, HEADS, kind).eval()
            row[f"{kind}_s"] = median_seconds(
                lambda layer=layer, x=x, mask=mask: layer(x, layer.context(x, mask)), repeats
            )
        rows.append(row)
    return rows


def draw(lengths: list[dict], attention: list[dict], path: Path) -> None:
    """Draw time and memory against length, and both kinds of attention."""
    figure, (time, memory, layer) = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
    seconds = [row["motion_s"] for row in lengths]
    time.plot(seconds, [row["plan_s"] for row in lengths], "o-", label="plan")
    time.plot(seconds, [row["sampling_s"] for row in lengths], "o-", label="of that, sampling")
    time.set(xlabel="length of the motion, s", ylabel="s")
    for name, when in (("peak", "peak_mb"), ("kept", "after_mb")):
        growth = [row[when] - row["before_mb"] for row in lengths]
        memory.plot(seconds, growth, "o-", label=name)
    memory.plot(seconds, [row["own_mb"] for row in lengths], "o-", label="the plan's own size")
    memory.set(xlabel="length of the motion, s", ylabel="MiB")
    tokens = [row["tokens"] for row in attention]
    for kind in ("efficient", "full"):
        layer.plot(tokens, [1e3 * row[f"{kind}_s"] for row in attention], "o-", label=kind)
    layer.set(xlabel="tokens", ylabel="ms for one attention layer")
    for axes in (time, memory, layer):
        axes.set_ylim(bottom=0.0)
        axes.grid(alpha=0.3)
        axes.legend()
    figure.savefig(path, dpi=110)
