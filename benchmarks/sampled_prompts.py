"""Prompts through the planner, a number of seeds each: what the benchmarks on prompts share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.progress import track

from motiondiffuse_ros.planner import Plan, Planner, PlannerConfig
from motiondiffuse_ros.request import MotionRequest

SECONDS = 5.0


@dataclass(frozen=True)
class Sampling:
    """How the prompts are sampled."""

    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    seeds: int = 8
    """Seeds 0 to this, exclusive."""
    candidates: int = PlannerConfig.candidates
    """Candidates a plan chooses from; 1 judges the bare sampler."""
    guidance_scale: float = PlannerConfig.guidance_scale
    """Weight of the text."""
    steps: int = PlannerConfig.steps
    """Denoising steps."""


def sample_prompts(
    texts: Sequence[str], sampling: Sampling
) -> tuple[dict[str, list[Plan]], dict[str, Any]]:
    """Plan every text with every seed.

    Returns:
        Plans by text, and the settings with the hash of the weights, for the record.
    """
    settings = asdict(sampling)
    seeds = settings.pop("seeds")
    planner = Planner(PlannerConfig(track=False, **settings))
    plans: dict[str, list[Plan]] = {text: [] for text in texts}
    for text, seed in track([(t, s) for t in plans for s in range(seeds)], "sampling"):
        plans[text].append(planner.plan(MotionRequest.from_text(text, SECONDS, seed=seed)))
    del settings["weights"]
    few_steps = next(iter(plans.values()))[0].few_steps_sha256
    hashes = {"weights_sha256": planner.weights_sha256, "few_steps_sha256": few_steps}
    return plans, {**hashes, "seeds": seeds, **settings}
