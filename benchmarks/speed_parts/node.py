"""The node as a process of its own, as a robot meets it.

python -m benchmarks.speed_parts.node --seconds 6 --parameters horizon 2.0
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import cycle, islice
from pathlib import Path
from typing import Any

import numpy as np
import tyro
import yaml
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from benchmarks.speed_parts.apart import measured_apart
from benchmarks.speed_parts.clock import memory_mb
from benchmarks.speed_parts.sampling import TEXT
from motiondiffuse_ros.msg import MotionPlan, MotionRequest, MotionSegment
from motiondiffuse_ros.ros.client import MotionClient
from motiondiffuse_ros.ros.processes import isolate, ros_arguments, running
from motiondiffuse_ros.ros.qos import COMMANDS, LATCHED, STREAM

PATIENCE = 120.0
"""For an answer [s]."""
TEXTS = (TEXT, TEXT.replace("right", "left"))
"""What the node is asked for in turn: the encoder remembers the sentence before."""
QUIET = 1.0
"""A stream of set-points that paused for longer has ended [s]."""


def measure_node(seconds: float, repeats: int, parameters: dict[str, object]) -> dict[str, Any]:
    """Start the node, and ask it for motions, one after the other.

    Every sentence is sent when the plan before it has come to its end: what a robot at rest
    waits for. The first answer does not count.

    Args:
        seconds: Length of the motions [s].
        repeats: Sentences that count.
        parameters: Of the node, beside the length.

    Returns:
        `startup_s`, from the start of the process to the first accepted goal; `text_to_plan_s`,
        from publishing a sentence to its plan's arrival; `first_setpoint_s`, to the first set-point
        that came of it; `rss_mb` and `rss_peak_mb`, resident memory after all of it and the most it
        ever was [MiB].
    """
    isolate(os.environ, os.getpid())
    arguments = ros_arguments(**{"default_seconds": seconds, **parameters})
    with tempfile.TemporaryDirectory() as folder, _Listener() as listener:
        began = time.perf_counter()
        log = Path(folder) / "node.log"
        with running("motiondiffuse_ros.ros.node", arguments, log) as process:
            listener.wait_for_node(PATIENCE)
            goal = listener.send(request_of(seconds), lambda feedback: None, PATIENCE)
            startup = time.perf_counter() - began
            listener.result(goal, PATIENCE)
            answers = [listener.ask(text) for text in islice(cycle(TEXTS), repeats + 1)][1:]
            memory = memory_mb(process.pid)
    plans, setpoints = zip(*answers, strict=True)
    return {
        "text_to_plan_s": {
            "median": float(np.median(plans)),
            "p95": float(np.percentile(plans, 95)),
            "all": list(plans),
        },
        "first_setpoint_s": float(np.median(setpoints)),
        "first_setpoint_all_s": list(setpoints),
        "startup_s": startup,
        "rss_mb": memory["now"],
        "rss_peak_mb": memory["peak"],
    }


def as_typed(parameters: Mapping[str, str]) -> dict[str, object]:
    """Return parameters of the node that were typed as YAML."""
    return {name: yaml.safe_load(text) for name, text in parameters.items()}


def _node_apart(seconds: float, repeats: int, parameters: dict[str, object]) -> dict[str, Any]:
    """Return what a process of its own measures with `measure_node`.

    A second measurement in the same process was seen to hang.
    """
    told = [word for name, value in parameters.items() for word in (name, str(value))]
    words = ("--seconds", str(seconds), "--repeats", str(repeats), "--parameters", *told)
    return measured_apart("benchmarks.speed_parts.node", *words)


def measure_starts(
    seconds: float, repeats: int, starts: int, parameters: dict[str, object]
) -> dict[str, Any]:
    """Return what a node shows, with the median of several starts; the last one is asked."""
    counts = [1] * (starts - 1) + [repeats]
    runs = [_node_apart(seconds, count, parameters) for count in counts]
    startup = [run["startup_s"] for run in runs]
    return {**runs[-1], "startup_s": float(np.median(startup)), "startup_all_s": startup}


def measure_streaming(
    seconds: float, repeats: int, parameters: dict[str, object]
) -> dict[str, object]:
    """Return what a node with some parameters takes to its first set-points."""
    figures = _node_apart(seconds, repeats, parameters)
    return {
        "parameters": parameters,
        **{name: figures[name] for name in ("first_setpoint_s", "first_setpoint_all_s")},
    }


class _Listener(MotionClient):
    """A client that notes when plans and set-points arrive."""

    def __init__(self) -> None:
        super().__init__()
        self._plan = self._first = self._last = 0.0
        self._text = self.node.create_publisher(String, "motiondiffuse/text", COMMANDS)
        self.node.create_subscription(MotionPlan, "motiondiffuse/plan", self._on_plan, LATCHED)
        self.node.create_subscription(
            JointState, "motiondiffuse/reference", self._on_setpoint, STREAM
        )

    def ask(self, text: str) -> tuple[float, float]:
        """Return the times from a sentence to its plan and to its first set-point [s]."""
        self.wait(lambda: time.perf_counter() - self._last > QUIET, PATIENCE, "rest")
        self._plan = self._first = 0.0
        began = time.perf_counter()
        self._text.publish(String(data=text))
        self.wait(lambda: bool(self._plan and self._first), PATIENCE, "a plan and its set-points")
        return self._plan - began, self._first - began

    def _on_plan(self, message: MotionPlan) -> None:
        self._plan = time.perf_counter()

    def _on_setpoint(self, message: JointState) -> None:
        self._last = time.perf_counter()
        self._first = self._first or self._last


def request_of(seconds: float) -> MotionRequest:
    """Return the request of so many seconds [s] that the node is measured with."""
    segment = MotionSegment(text=TEXT, start=0.0, end=seconds)
    return MotionRequest(segments=[segment], duration=seconds)


@dataclass(frozen=True)
class Options:
    """What to ask a node for."""

    seconds: float = 6.0
    """Length of the motions [s]."""
    repeats: int = 20
    """Sentences that count."""
    parameters: dict[str, str] = field(default_factory=dict)
    """Parameters of the node, beside the length, as YAML has them."""


def main(options: Options) -> None:
    """Measure a node that is started once, and print the figures as JSON."""
    parameters = as_typed(options.parameters)
    print(json.dumps(measure_node(options.seconds, options.repeats, parameters)))


if __name__ == "__main__":
    main(tyro.cli(Options))
