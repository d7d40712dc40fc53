"""What the tests with real ROS processes share."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from motiondiffuse_ros.ros.processes import isolate

START = 120.0
"""For a node to load on a busy machine [s]."""

ANSWER = 120.0
"""For an answer of a node that runs [s]."""

FAST = {"steps": 6, "candidates": 1, "track": False}
"""Parameters for plans that are quick rather than good."""

_graphs = itertools.count(os.getpid())


@contextmanager
def own_graph(folder: Path) -> Iterator[Path]:
    """A ROS domain for this process and its children; returns the folder, for logs."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE"):
            patch.delenv(name, raising=False)
        settings: dict[str, str] = {}
        isolate(settings, next(_graphs))
        settings["ROS_LOG_DIR"] = str(folder / "ros")
        settings["FASTDDS_DEFAULT_PROFILES_FILE"] = str(
            Path(__file__).parent / "system" / "fast.xml"
        )
        for name, value in settings.items():
            patch.setenv(name, value)
        yield folder
