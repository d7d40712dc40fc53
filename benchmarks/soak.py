"""A node under random goals, cancels, preempts and bad requests for a long time.

Samples the memory of the node's process and counts how goals end. Fails if what it holds grows
after the warm-up by more than noise explains, a goal gets no result, or the node does not plan any
more.

    python -m benchmarks.soak --minutes 30 --json benchmarks/soak.json --plot docs/soak.png
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections import Counter
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rclpy.action.client import ClientGoalHandle
from rclpy.task import Future

from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.msg import MotionRequest, MotionSegment
from motiondiffuse_ros.ros.client import Feedback, MotionClient
from motiondiffuse_ros.ros.processes import isolate, ros_arguments, running

START = 180.0
"""For the node to load on a busy machine [s]."""

ANSWER = 60.0
"""A goal without a result for so long is lost [s]."""

SAMPLE = 2.0
"""Between two samples of memory [s]."""

HELD = 60.0
"""Memory counts by its least value over so long [s]: what a goal borrows and gives back is none."""

NEGLIGIBLE = 1.0
"""Growth that does not count [MB/h]: half an hour does not show less."""

LONG = 100
"""Denoising steps of goals that are to be ended before they are done."""

TEXTS = (
    *("a person walks forward", "a person waves with the right hand", "a person bows"),
    *("a person jumps", "a person turns left", "a person raises both arms"),
)
BAD = ("", "... 123", "walk " * 100)
WAYS = ("let", "cancel", "overtake", "bad")
SHARES = (0.45, 0.25, 0.2, 0.1)


@dataclass(frozen=True)
class SoakConfig:
    """How long and how hard.

    Attributes:
        minutes: Length, min.
        warm_up: Share of it that the slope of memory leaves out [1].
        pause: Mean time between the end of a goal and the next one, s.
        seed: Of the choices.
    """

    minutes: float = 30.0
    warm_up: float = 0.2
    pause: float = 2.5
    seed: int = 1

    def validate(self) -> None:
        """Raise ValueError if a value is out of range."""
        if self.minutes <= 0.0 or self.pause < 0.0 or not 0.0 <= self.warm_up < 1.0:
            raise ValueError(f"minutes above 0, pause from 0, warm_up below 1; got {self}")


@dataclass
class Log:
    """What happened.

    Attributes:
        samples: (time from the start in s, resident memory in bytes).
        outcomes: Goals by their result's code.
        ways: Goals by what was done with them.
        states: Goals by the action's terminal state.
        lost: Goals without a result.
    """

    samples: list[tuple[float, int]] = field(default_factory=list)
    outcomes: Counter[str] = field(default_factory=Counter)
    ways: Counter[str] = field(default_factory=Counter)
    states: Counter[str] = field(default_factory=Counter)
    lost: int = 0


STATES = {4: "succeeded", 5: "canceled", 6: "aborted"}


class Soak:
    """Sends goals one after another and does something random with each."""

    def __init__(self, client: MotionClient, pid: int, config: SoakConfig) -> None:
        """Take who sends, whose memory counts, and how."""
        self._client, self._pid, self._config = client, pid, config
        self._random = np.random.default_rng(config.seed)
        self._began = time.monotonic()
        self.log = Log()

    def run(self) -> Log:
        """Go on for the whole time."""
        end = self._began + 60.0 * self._config.minutes
        while time.monotonic() < end:
            way = str(self._random.choice(WAYS, p=SHARES))
            self.log.ways[way] += 1
            self._one(way)
            self._idle(self._random.exponential(self._config.pause))
        return self.log

    def _one(self, way: str) -> None:
        ended_early = way in ("cancel", "overtake")
        goals = [self._send(bad=way == "bad", steps=LONG if ended_early else 0)]
        if ended_early:
            self._idle(self._random.uniform(0.0, 0.6))
        if way == "cancel":
            goals[0].cancel_goal_async()
        if way == "overtake":
            goals += [self._send() for _ in range(self._random.integers(1, 4))]
        futures = [goal.get_result_async() for goal in goals]
        for future in futures:
            self._finish(future)

    def _send(self, *, bad: bool = False, steps: int = 0) -> ClientGoalHandle:
        text = str(self._random.choice(BAD if bad else TEXTS))
        segment = MotionSegment(text=text, start=0.0, end=float(self._random.uniform(0.6, 2.0)))
        return self._client.send(MotionRequest(segments=[segment], steps=steps), _ignore, ANSWER)

    def _finish(self, future: Future) -> None:
        deadline = time.monotonic() + ANSWER
        while not future.done() and time.monotonic() < deadline:
            self._idle(0.1)
        answer = future.result() if future.done() else None
        if answer is None:
            self.log.lost += 1
            return
        self.log.states[STATES.get(answer.status, str(answer.status))] += 1
        self.log.outcomes[ErrorCode(answer.result.error_code).name] += 1

    def _idle(self, seconds: float) -> None:
        """Handle events, and sample memory where it is due."""
        until = time.monotonic() + seconds
        while True:
            now = time.monotonic()
            if not self.log.samples or now - self._began - self.log.samples[-1][0] >= SAMPLE:
                self.log.samples.append((now - self._began, resident_bytes(self._pid)))
            if now >= until:
                return
            self._client.spin(min(until - now, 0.1))


def resident_bytes(pid: int) -> int:
    """Return the resident memory of a process [B]."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def growth(times: NDArray[np.float64], values: NDArray[np.float64]) -> tuple[float, float]:
    """Return slope and half width of its 95 % interval, by moving-block bootstrap of the residuals.

    Memory is not independent from one sample to the next, so blocks of a tenth of the time are
    drawn together.

    Args:
        times: [N].
        values: [N].
    """
    fit = np.polyfit(times, values, 1)
    rest = values - np.polyval(fit, times)
    block = max(1, len(times) // 10)
    random = np.random.default_rng(0)
    slopes = []
    for _ in range(1000):
        starts = random.integers(0, len(times) - block + 1, size=-(-len(times) // block))
        drawn = np.concatenate([rest[s : s + block] for s in starts])[: len(times)]
        slopes.append(np.polyfit(times, np.polyval(fit, times) + drawn, 1)[0])
    low, high = np.percentile(slopes, [2.5, 97.5])
    return float(fit[0]), float((high - low) / 2.0)


def summary(log: Log, config: SoakConfig) -> dict[str, object]:
    """Return the figures that count."""
    samples = np.array(log.samples)
    megabytes = samples[:, 1] / 1e6
    kept = samples[:, 0] >= config.warm_up * samples[-1, 0]
    minute = samples[kept, 0] // HELD
    minutes = np.unique(minute)
    least = np.array([megabytes[kept][minute == m].min() for m in minutes])
    slope, margin = growth(minutes * HELD / 3600.0, least)
    return {
        "config": asdict(config),
        "minutes": round(float(samples[-1, 0]) / 60.0, 2),
        "goals": sum(log.states.values()) + log.lost,
        "lost": log.lost,
        "by_state": dict(log.states),
        "by_code": dict(log.outcomes),
        "by_way": dict(log.ways),
        "rss_mb": {
            "after_warm_up": round(float(megabytes[kept][0]), 1),
            "last": round(float(megabytes[-1]), 1),
            "greatest": round(float(megabytes.max()), 1),
        },
        "slope_mb_per_hour": round(slope, 2),
        "slope_ci95_mb_per_hour": round(margin, 2),
    }


def plot(log: Log, figures: dict[str, object], config: SoakConfig, path: Path) -> None:
    """Draw memory over time."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    samples = np.array(log.samples)
    figure, axes = pyplot.subplots(figsize=(7.0, 3.0))
    axes.plot(samples[:, 0] / 60.0, samples[:, 1] / 1e6, color="0.2", linewidth=0.8)
    axes.axvspan(0.0, config.warm_up * samples[-1, 0] / 60.0, color="0.92")
    axes.set_xlabel("minutes")
    axes.set_ylabel("resident memory [MB]")
    axes.set_title(
        f"{figures['goals']} goals, {figures['lost']} lost; {figures['slope_mb_per_hour']} ± "
        f"{figures['slope_ci95_mb_per_hour']} MB/h after the warm-up (grey)"
    )
    figure.tight_layout()
    figure.savefig(path, dpi=120)


def _ignore(feedback: Feedback) -> None:
    pass


def main() -> int:
    """Run it; returns 1 if memory grew, a goal was lost or the node is stuck."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=SoakConfig.minutes)
    parser.add_argument("--pause", type=float, default=SoakConfig.pause)
    parser.add_argument("--warm-up", type=float, default=SoakConfig.warm_up)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--plot", type=Path)
    arguments = parser.parse_args()
    config = SoakConfig(arguments.minutes, arguments.warm_up, arguments.pause)
    config.validate()
    isolate(os.environ, os.getpid())
    parameters = ros_arguments(steps=4, candidates=1, track=False, preempt=True)
    log_file = Path(tempfile.mkdtemp(prefix="soak")) / "node.log"
    with (
        running("motiondiffuse_ros.ros.node", parameters, log_file) as process,
        MotionClient(lambda: process.poll() is None) as client,
    ):
        client.wait_for_node(START)
        log = Soak(client, process.pid, config).run()
        last = MotionRequest(segments=[MotionSegment(text=TEXTS[0], start=0.0, end=1.0)])
        stuck = client.generate(last, _ignore, ANSWER).error_code != ErrorCode.SUCCESS
    figures = {**summary(log, config), "stuck": stuck, "exit_code": process.returncode}
    figures["tracebacks"] = log_file.read_text().count("Traceback")
    print(json.dumps(figures, indent=2))
    if arguments.json:
        content = {**figures, "samples": [(round(t, 1), b) for t, b in log.samples]}
        arguments.json.write_text(json.dumps(content) + "\n")
    if arguments.plot:
        plot(log, figures, config, arguments.plot)
    slope, margin = figures["slope_mb_per_hour"], figures["slope_ci95_mb_per_hour"]
    assert isinstance(slope, float)
    assert isinstance(margin, float)
    return int(log.lost > 0 or stuck or slope > max(margin, NEGLIGIBLE))


if __name__ == "__main__":
    sys.exit(main())
