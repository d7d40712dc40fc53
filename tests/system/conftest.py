"""Real processes on ROS graphs of their own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from ros_graph import FAST, START, own_graph

from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.ros.client import MotionClient
from motiondiffuse_ros.ros.processes import ros_arguments, running


@pytest.fixture
def graph(tmp_path) -> Iterator[Path]:
    """A ROS domain for one test; returns a folder for logs."""
    with own_graph(tmp_path) as folder:
        yield folder


@pytest.fixture(scope="session")
def node(tmp_path_factory) -> Iterator[Path]:
    """A running `motiondiffuse` node with the shipped weights, in a domain of its own.

    Returns its log. Loading takes a while, so all tests that need one share it.
    """
    if not (shipped_weights() / "config.json").is_file():
        pytest.skip("no weights are shipped yet")
    with own_graph(tmp_path_factory.mktemp("node")) as folder:
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
