"""Sampling against the paper's configuration, and against the machine's arithmetic."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch.utils.flop_counter import FlopCounterMode

from benchmarks.speed_parts.clock import median_seconds
from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.precision import use_bf16
from motiondiffuse_ros.diffusion.process import make_scheduler
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.planner import PlannerConfig, shipped_weights

PAPER_STEPS = 1000
MATRIX = 2048
"""Size of the square matrices whose product gives the machine's rate."""
TEXT = "a person walks forward and waves with the right hand"
"""What every part is asked for."""


@dataclass(frozen=True)
class SamplingSpeed:
    """Times of one request's sampling.

    Attributes:
        seconds: Ours, with text, noise and decoding [s].
        operations: Floating-point operations of its matrix products.
        rate: Operations a second of large matrix products in the arithmetic we use.
        rate_fp32: The same in float32.
        paper: The paper's configuration in float32, its 1000 steps scaled from fewer [s].
        paper_same_arithmetic: The same in the arithmetic that we use [s].
        paper_one: The same in float32 of one motion instead of all candidates [s].
    """

    seconds: float
    operations: float
    rate: float
    rate_fp32: float
    paper: float
    paper_same_arithmetic: float
    paper_one: float

    def to_dict(self) -> dict[str, float]:
        """Return the figures with their ratios."""
        floor = self.operations / self.rate
        return {
            "sampling_s": self.seconds,
            "paper_s": self.paper,
            "paper_same_arithmetic_s": self.paper_same_arithmetic,
            "paper_one_motion_s": self.paper_one,
            "ratio_to_paper": self.paper / self.seconds,
            "ratio_to_paper_same_arithmetic": self.paper_same_arithmetic / self.seconds,
            "ratio_to_paper_one_motion": self.paper_one / self.seconds,
            "floor_s": floor,
            "ratio_to_floor": self.seconds / floor,
            "gigaflop": self.operations / 1e9,
            "gigaflops": self.rate / 1e9,
            "gigaflops_fp32": self.rate_fp32 / 1e9,
        }


def sample_seconds(
    pipeline: MotionPipeline, seconds: float, candidates: int, repeats: int
) -> float:
    """Return the median time to sample one request of one text [s].

    As many candidates are sampled to the end as the planner lets; which ones does not matter here.
    """
    return median_seconds(lambda: _sample(pipeline, seconds, candidates), repeats)


def measure_sampling(
    seconds: float, candidates: int, repeats: int, paper_steps: int
) -> SamplingSpeed:
    """Measure ours and the paper's on the same request, in this process.

    Args:
        seconds: Length of the motion [s].
        candidates: Motions sampled at once.
        repeats: Of ours.
        paper_steps: Steps of the paper's 1000 that are run.
    """
    pipeline = MotionPipeline.from_pretrained(shipped_weights())
    frames = round(seconds * pipeline.fps) + 1
    ours = sample_seconds(pipeline, seconds, candidates, repeats)
    packed = {torch.ops.mkldnn._linear_pointwise: _linear_operations}
    with FlopCounterMode(display=False, custom_mapping=packed) as counter:
        _sample(pipeline, seconds, candidates)
    bf16 = use_bf16(SamplerConfig.precision)
    step = _paper_step_seconds(frames, candidates, paper_steps, bf16=False)
    return SamplingSpeed(
        seconds=ours,
        operations=float(counter.get_total_flops()),
        rate=_product_rate(torch.bfloat16 if bf16 else torch.float32),
        rate_fp32=_product_rate(torch.float32),
        paper=PAPER_STEPS * step,
        paper_same_arithmetic=PAPER_STEPS
        * (_paper_step_seconds(frames, candidates, paper_steps, bf16=True) if bf16 else step),
        paper_one=PAPER_STEPS * _paper_step_seconds(frames, 1, paper_steps, bf16=False),
    )


def _linear_operations(x: torch.Size, weight: torch.Size, *_: object, **__: object) -> int:
    """Return the operations of `diffusion.product.Product`, which the counter does not know."""
    return 2 * x.numel() * weight[0]


def _sample(pipeline: MotionPipeline, seconds: float, candidates: int) -> None:
    frames = round(seconds * pipeline.fps) + 1
    pipeline(
        (TimedText(TEXT, 0, frames, ()),),
        frames,
        config=SamplerConfig(),
        candidates=candidates,
        choose=lambda features: range(min(PlannerConfig.survivors, len(features))),
        seed=0,
        blend_frames=10,
    )


@torch.inference_mode()
def _paper_step_seconds(frames: int, rows: int, steps: int, *, bf16: bool) -> float:
    """Return the median time of one DDPM step of `DenoiserConfig.paper()` with random weights.

    As published, without guidance; the text's cross-attention is computed once, as here.
    """
    torch.manual_seed(0)
    config = DenoiserConfig.paper()
    denoiser = Denoiser(config).eval()
    tokens = torch.randn(rows, 12, config.text_dim)
    conditioning = denoiser.condition(tokens, torch.ones(rows, 12, dtype=torch.bool))
    scheduler = make_scheduler("ddpm", config)
    scheduler.set_timesteps(PAPER_STEPS)
    lengths = torch.full((rows,), frames)
    x = torch.randn(rows, frames, config.feature_dim)
    times = iter(scheduler.timesteps)

    def step() -> None:
        at = next(times)
        with torch.autocast("cpu", torch.bfloat16, enabled=bf16):
            noise = denoiser(x, at.expand(rows), lengths, conditioning)
        scheduler.step(noise, at, x)  # type: ignore[arg-type]

    return median_seconds(step, steps)


@torch.inference_mode()
def _product_rate(dtype: torch.dtype) -> float:
    a, b = (torch.randn(MATRIX, MATRIX).to(dtype) for _ in range(2))
    return 2.0 * MATRIX**3 / median_seconds(lambda: torch.mm(a, b), 15)
