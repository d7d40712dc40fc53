"""How fast the node lets go of a goal, and how often it tells where it stands.

    python -m benchmarks.letting_go --json benchmarks/letting_go.json

Goals of 6 s with the default settings. Some are left alone, which gives the length of a denoising
step and the gaps between feedbacks; the others are cancelled after a random share of that time.
Asked: a result within one denoising step and 100 ms of the cancel, feedback at 5 Hz or more.
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from benchmarks.speed_parts.clock import machine
from benchmarks.speed_parts.node import request_of
from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.ros.client import MotionClient
from motiondiffuse_ros.ros.processes import isolate, ros_arguments, running

PATIENCE = 180.0
"""For an answer [s]."""

GRACE_MS = 100.0
LONGEST_GAP_MS = 200.0


@dataclass(frozen=True)
class Options:
    """How many goals."""

    cancels: int = 60
    """Goals that are cancelled."""
    whole: int = 20
    """Goals that are left alone."""
    seconds: float = 6.0
    """Length of the motions [s]."""
    seed: int = 0
    """Of the moments of the cancels."""
    json: Path | None = None
    """Where to write the figures."""


def measure(options: Options) -> dict[str, object]:
    """Return the figures, times in ms."""
    isolate(os.environ, os.getpid())
    with tempfile.TemporaryDirectory() as folder, MotionClient() as client:
        log = Path(folder) / "node.log"
        with running("motiondiffuse_ros.ros.node", ros_arguments(), log):
            client.wait_for_node(PATIENCE)
            _whole(client, options.seconds)  # the first goal pays for what is loaded late
            alone = [_whole(client, options.seconds) for _ in range(options.whole)]
            lasts = float(np.median([total for total, _, _ in alone]))
            random = np.random.default_rng(options.seed)
            moments = random.uniform(0.0, lasts, options.cancels)
            cancelled = [_cancelled(client, options.seconds, at) for at in moments]
    steps = 1e3 * np.array([step for _, step, _ in alone])
    gaps = 1e3 * np.concatenate([gap for _, _, gap in alone])
    waits = 1e3 * np.array([wait for wait, code in cancelled if code == ErrorCode.CANCELED])
    figures = {
        "goal": [float(np.median([1e3 * total for total, _, _ in alone]))],
        "denoising_step": [float(np.median(steps)), float(steps.max())],
        "between_feedbacks": [float(np.median(gaps)), *map(float, np.percentile(gaps, [95, 100]))],
        "cancel_to_result": [
            float(np.median(waits)),
            *map(float, np.percentile(waits, [95, 100])),
        ],
    }
    ended = [code.name for _, code in cancelled]
    return {
        "machine": machine(),
        "options": {k: v for k, v in asdict(options).items() if k != "json"},
        "ended": {name: ended.count(name) for name in sorted(set(ended))},
        "in_time": float(np.mean(waits <= np.median(steps) + GRACE_MS)),
        "gaps_at_5_hz": float(np.mean(gaps <= LONGEST_GAP_MS)),
        "milliseconds": figures,
    }


def _whole(client: MotionClient, seconds: float) -> tuple[float, float, np.ndarray]:
    """Return time to the result, of a denoising step, and between feedbacks, s."""
    told: list[float] = []
    began = time.perf_counter()
    result = client.generate(
        request_of(seconds), lambda _: told.append(time.perf_counter()), PATIENCE
    )
    ended = time.perf_counter()
    assert result.error_code == ErrorCode.SUCCESS, result.message
    step = result.plan.sampling_time / result.plan.request.steps
    return ended - began, step, np.diff([began, *told, ended])


def _cancelled(client: MotionClient, seconds: float, after: float) -> tuple[float, ErrorCode]:
    """Return the time from a cancel to the result [s], and how the goal ended."""
    began = time.perf_counter()
    goal = client.send(request_of(seconds), lambda _: None, PATIENCE)
    while (left := began + after - time.perf_counter()) > 0.0:
        client.spin(left)
    asked = time.perf_counter()
    goal.cancel_goal_async()
    result = client.result(goal, PATIENCE)
    return time.perf_counter() - asked, ErrorCode(result.error_code)


def main(options: Options) -> None:
    """Measure, print, write."""
    figures = measure(options)
    table = Table("ms", "median", "95 %, greatest")
    milliseconds = figures["milliseconds"]
    assert isinstance(milliseconds, dict)
    for name, (median, *others) in milliseconds.items():
        table.add_row(
            name.replace("_", " "), f"{median:.0f}", ", ".join(f"{x:.0f}" for x in others)
        )
    console = Console(width=100)
    console.print(table)
    console.print({key: figures[key] for key in ("ended", "in_time", "gaps_at_5_hz")})
    if options.json is not None:
        options.json.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(tyro.cli(Options))
