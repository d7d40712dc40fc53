"""Nodes as processes of their own, without `ros2 run` or launch."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator, MutableMapping
from contextlib import contextmanager
from pathlib import Path

GRACE = 20.0
"""Time that a process gets to end after SIGINT before it is killed [s]."""

LAST_DOMAIN = 101
"""Domains up to this one use ports below Linux's ephemeral ones."""


def isolate(environment: MutableMapping[str, str], key: int) -> None:
    """Keep this process and its children to this machine and, unless one is set, a domain.

    Args:
        environment: Changed in place, before rclpy is initialised; usually `os.environ`.
        key: Chooses the domain, such as the process id.
    """
    environment.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    environment.setdefault("ROS_DOMAIN_ID", str(1 + key % LAST_DOMAIN))


def ros_arguments(name: str | None = None, **parameters: object) -> list[str]:
    """Return the command line that sets a node's parameters and, if given, its name."""
    arguments = ["--ros-args"]
    if name is not None:
        arguments += ["-r", f"__node:={name}"]
    for key, value in parameters.items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        # quoted, or rcl reads an empty string or a path of digits as something else
        arguments += [
            "-p",
            f'{key}:="{text}"' if isinstance(value, (str, Path)) else f"{key}:={text}",
        ]
    return arguments


@contextmanager
def running(module: str, arguments: list[str], log: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Run `python -m module` until the block ends, then stop it with SIGINT.

    Args:
        module: With a `main` that spins a node.
        arguments: Command line.
        log: File for what it prints.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("wb") as file:
        process = subprocess.Popen(
            [sys.executable, "-m", module, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=subprocess.STDOUT,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
            # Ctrl-C in the terminal is for the parent, which then stops its children
            start_new_session=True,
        )
        try:
            yield process
        finally:
            stop(process)


def stop(process: subprocess.Popen[bytes]) -> int:
    """End a process as Ctrl-C would, or by force after `GRACE`; returns its exit code."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(GRACE)
        except subprocess.TimeoutExpired:
            process.kill()
    return process.wait()
