"""Files that come from outside: no larger than they can sensibly be, and YAML without surprises."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from motiondiffuse_ros.errors import MotionDiffuseError

MOST_YAML = 1_000_000
"""Largest request or robot description [B]."""

MOST_MOTION = 200_000_000
"""Largest BVH or npz file of a motion [B]."""


def is_file(path: Path) -> bool:
    """Return whether there is a file; a name that no file can have is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def check_size(path: Path, most: int, refusal: type[MotionDiffuseError]) -> None:
    """Refuse a file of more than `most` bytes.

    Raises:
        MotionDiffuseError: Of the kind `refusal`.
        OSError: If there is no such file.
    """
    size = path.stat().st_size
    if size > most:
        raise refusal(f"{path}: {size} bytes, at most {most}")


def load_yaml(path: Path, refusal: type[MotionDiffuseError]) -> Any:
    """Read a YAML file.

    Raises:
        MotionDiffuseError: Of the kind `refusal`, if it is too large or not YAML.
        OSError: If it cannot be read.
    """
    check_size(path, MOST_YAML, refusal)
    try:
        return yaml.safe_load(path.read_text(encoding="utf-8"))
    # dates and numbers that are none are ValueErrors, as is text that is not UTF-8
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise refusal(f"{path}: not YAML ({' '.join(str(error).split())})") from error
