"""Run one node from start to a clean end."""

from __future__ import annotations

import gc
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import TypeVar

import rclpy
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.executors import (
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

AnyNode = TypeVar("AnyNode", bound=Node)

_PERIOD = 0.1
_LAST_WORDS = 1.0
"""Time for the answers of ended work to leave [s]."""


def run_node(
    create: Callable[[], AnyNode],
    args: Sequence[str] | None = None,
    *,
    threads: int,
    finish: Callable[[AnyNode], None] = lambda node: None,
) -> int:
    """Spin a node until Ctrl-C, SIGTERM or shutdown.

    Args:
        create: Makes the node, once rclpy is up.
        args: Command line with `--ros-args`; the process's own if None.
        threads: Of the executor. With one, everything that is ready gets its turn; with more, a
            timer that is always late keeps the rest of its callback group waiting for ever.
        finish: Ends the node's work while it can still answer its clients.

    Returns:
        Exit code: 0, or 2 if a parameter was refused (one line on stderr).
    """
    stop = threading.Event()
    # rclpy's own handlers would cut the node off before it has answered; and under a launcher
    # Ctrl-C arrives twice
    for kind in (signal.SIGINT, signal.SIGTERM):
        signal.signal(kind, lambda *_: stop.set())
    rclpy.init(
        args=list(args) if args is not None else None,
        signal_handler_options=SignalHandlerOptions.NO,
    )
    try:
        node = create()
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        print(f"parameter refused: {error}", file=sys.stderr)
        rclpy.try_shutdown()
        return 2
    executor = SingleThreadedExecutor() if threads == 1 else MultiThreadedExecutor(threads)
    executor.add_node(node)
    try:
        while not stop.is_set():
            executor.spin_once(timeout_sec=_PERIOD)
        finish(node)
        deadline = time.monotonic() + _LAST_WORDS
        while time.monotonic() < deadline:
            executor.spin_once(timeout_sec=_PERIOD)
    except ExternalShutdownException:
        finish(node)
    executor.shutdown()
    node.destroy_node()
    rclpy.try_shutdown()
    gc.freeze()  # spares the interpreter a last walk through all of torch: 0.7 s
    return 0
