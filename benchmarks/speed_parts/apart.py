"""Measurements by a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any


def measured_apart(module: str, *words: str) -> dict[str, Any]:
    """Run a module that prints figures as JSON in its last line, and return them.

    Args:
        module: Run as `python -m`.
        words: Its command line.
    """
    ended = subprocess.run(
        [sys.executable, "-m", module, *words], check=True, capture_output=True, text=True
    )
    return json.loads(ended.stdout.splitlines()[-1])
