"""Times as medians over repeats, and memory of processes."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np


def median_seconds(work: Callable[[], object], repeats: int) -> float:
    """Return the median wall time of some work [s], after one call that does not count."""
    work()
    return float(np.median([seconds(work) for _ in range(repeats)]))


def seconds(work: Callable[[], object]) -> float:
    """Return the wall time of one call [s]."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def memory_mb(pid: int | None = None) -> dict[str, float]:
    """Return resident memory of a process [MiB]: `now`, and its `peak` since `forget_peak`."""
    status = Path(f"/proc/{pid or os.getpid()}/status").read_text(encoding="utf-8")
    fields = dict(line.split(":", 1) for line in status.splitlines() if ":" in line)
    names = {"now": "VmRSS", "peak": "VmHWM"}
    return {ours: int(fields[theirs].split()[0]) / 1024 for ours, theirs in names.items()}


def forget_peak() -> None:
    """Let this process's peak begin at what it holds now."""
    Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")


def machine() -> dict[str, object]:
    """Name the machine, and say how busy it is with other things."""
    names = [
        line.partition(":")[2].strip()
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        if line.startswith(("model name", "flags"))
    ]
    flags = set(names[1].split())
    return {
        "processor": names[0],
        "matrix_units": sorted(flags & {"amx_bf16", "avx512_bf16", "avx512f", "avx2"}),
        "cores": len(os.sched_getaffinity(0)),
        "load_before": os.getloadavg()[0],
    }
