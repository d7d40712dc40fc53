"""What besides input and weights may decide the last bits of a plan: code, libraries, machine."""

from __future__ import annotations

import os
import platform
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import torch

from motiondiffuse_ros import __version__

LIBRARIES = (
    *("torch", "numpy", "scipy", "mujoco", "mink", "daqp", "qpsolvers", "roma"),
    *("transformers", "tokenizers", "safetensors"),
)
"""Distributions that have a part in plans."""

_SOURCES = {".py", ".json", ".yaml"}


def surroundings() -> dict[str, str]:
    """Return code, libraries and machine of this process by name."""
    found = {"motiondiffuse_ros": __version__, "code": _code()}
    found |= {name: _version(name) for name in LIBRARIES}
    found |= {"python": platform.python_version(), "machine": platform.machine()}
    return found | {
        "processor": _processor(),
        "vector instructions": torch.backends.cpu.get_cpu_capability(),
        "OPENBLAS_NUM_THREADS": os.environ.get("OPENBLAS_NUM_THREADS", "not set"),
    }


@cache
def _code() -> str:
    """Return the SHA-256 of the package's own code and tables; its version alone says little."""
    package, digest = Path(__file__).resolve().parents[1], sha256()
    for path in sorted(package.rglob("*")):
        inside = path.relative_to(package)
        if path.suffix in _SOURCES and inside.parts[0] != "weights":
            digest.update(f"{inside}\0{sha256(path.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((x.partition(":")[2].strip() for x in lines if x.startswith("model name")), "")
