"""Run one node from start to a clean end."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Sequence

import rclpy
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def run_node(create: Callable[[], Node], args: Sequence[str] | None = None, *, threads: int) -> int:
    """Spin a node until Ctrl-C, SIGTERM or shutdown; its `destroy_node` ends what it started.

    Args:
        create: Makes the node, once rclpy is up.
        args: Command line with `--ros-args`; the process's own if None.
        threads: Of the executor.

    Returns:
        Exit code: 0, or 2 if a parameter was refused (one line on stderr).
    """
    rclpy.init(args=list(args) if args is not None else None)
    try:
        node = create()
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        print(f"parameter refused: {error}", file=sys.stderr)
        rclpy.try_shutdown()
        return 2
    executor = MultiThreadedExecutor(num_threads=threads)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        # under a launcher Ctrl-C arrives twice: from the terminal and from the launcher
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        node.destroy_node()
        executor.shutdown()
        rclpy.try_shutdown()
    return 0
