"""Time and memory of one long motion in a process of its own.

python -m benchmarks.speed_parts.long_motion --seconds 600 [--candidates 4]
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, is_dataclass

import numpy as np
import tyro

from benchmarks.speed_parts.apart import measured_apart
from benchmarks.speed_parts.clock import forget_peak, memory_mb, seconds


@dataclass(frozen=True)
class Options:
    """What to plan."""

    seconds: float
    """Length of the motion [s]."""
    candidates: int = 4
    """Motions to choose from."""


def measure_long(length: float, candidates: int) -> dict[str, float]:
    """Plan a motion in a new process that has planned 2 s before.

    Returns:
        `motion_s` and `plan_s` [s]; `before_mb`, `peak_mb` and `after_mb`, resident memory before,
        its peak while planning and with the plan made; `own_mb`, the bytes of the plan's arrays.
    """
    words = ("--seconds", str(length), "--candidates", str(candidates))
    return measured_apart("benchmarks.speed_parts.long_motion", *words)


def _sizes(held: object) -> dict[int, int]:
    """Return the bytes of all arrays in a record and the records in it, by identity."""
    if isinstance(held, np.ndarray):
        return {id(held): held.nbytes}
    if isinstance(held, Mapping):
        parts = list(held.values())
    elif is_dataclass(held):
        parts = list(vars(held).values())  # computed ones, too
    else:
        parts = list(held) if isinstance(held, tuple) else []
    return {key: size for part in parts for key, size in _sizes(part).items()}


def main(options: Options) -> None:
    """Plan, and print the figures as JSON."""
    from motiondiffuse_ros.memory import return_freed_memory
    from motiondiffuse_ros.planner import Planner, PlannerConfig
    from motiondiffuse_ros.request import MotionRequest

    planner = Planner(PlannerConfig(candidates=options.candidates))
    text = "a person walks forward"
    planner.plan(MotionRequest.from_text(text, 2.0, seed=0))
    return_freed_memory()
    forget_peak()
    before = memory_mb()["now"]
    plans = []
    request = MotionRequest.from_text(text, options.seconds, seed=0)
    took = seconds(lambda: plans.append(planner.plan(request)))
    memory = memory_mb()
    figures = {
        "motion_s": options.seconds,
        "plan_s": took,
        "before_mb": before,
        "peak_mb": memory["peak"],
        "after_mb": memory["now"],
        "own_mb": sum(_sizes(plans[0]).values()) / 2**20,
        **{f"{stage}_s": value for stage, value in plans[0].timings_s.items()},
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main(tyro.cli(Options))
