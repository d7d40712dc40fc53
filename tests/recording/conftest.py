"""One planner and one plan for the tests of recordings."""

import pytest

from motiondiffuse_ros.planner import Planner, PlannerConfig, shipped_weights
from motiondiffuse_ros.recording import record_of
from motiondiffuse_ros.request import MotionRequest


@pytest.fixture(scope="package")
def planner():
    if not (shipped_weights() / "config.json").is_file():
        pytest.skip("no weights are shipped yet")
    return Planner(PlannerConfig(steps=4, candidates=2, track=False, accelerations=True))


@pytest.fixture(scope="package")
def plan(planner):
    return planner.plan(MotionRequest.from_text("a person walks forward", 2.0))


@pytest.fixture
def record(planner, plan):
    return record_of(planner, plan)
