"""Real processes on ROS graphs of their own."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from ros_graph import FAST, START

from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.ros.client import MotionClient
from motiondiffuse_ros.ros.processes import isolate, ros_arguments, running

_graphs = itertools.count(os.getpid())


@contextmanager
def _own_graph(folder: Path) -> Iterator[Path]:
    with pytest.MonkeyPatch.context() as patch:
        for name in ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE"):
            patch.delenv(name, raising=False)
        settings: dict[str, str] = {}
        isolate(settings, next(_graphs))
        settings["ROS_LOG_DIR"] = str(folder / "ros")
        settings["FASTDDS_DEFAULT_PROFILES_FILE"] = str(Path(__file__).with_name("fast.xml"))
        for name, value in settings.items():
            patch.setenv(name, value)
        yield folder


@pytest.fixture
def graph(tmp_path) -> Iterator[Path]:
    """A ROS domain for one test; returns a folder for logs."""
    with _own_graph(tmp_path) as folder:
        yield folder


@pytest.fixture(scope="session")
def node(tmp_path_factory) -> Iterator[Path]:
    """A running `motiondiffuse` node with the shipped weights, in a domain of its own.

    Returns its log. Loading takes a while, so all tests that need one share it.
    """
    if not (shipped_weights() / "config.json").is_file():
        pytest.skip("no weights are shipped yet")
    with _own_graph(tmp_path_factory.mktemp("node")) as folder:
        log = folder / "node.log"
        # plans that go on from one another would not be the same for the same seed
        arguments = ros_arguments(**FAST, continuity=False)
        with running("motiondiffuse_ros.ros.node", arguments, log) as process:
            with MotionClient(lambda: process.poll() is None) as client:
                client.wait_for_node(START)
            yield log


@pytest.fixture
def client(node) -> Iterator[MotionClient]:
    """A client of the running node."""
    with MotionClient() as client:
        client.wait_for_node(START)
        yield client
