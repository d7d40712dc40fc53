"""Plans may be executed in simulation first, and what was executed published instead."""

import numpy as np
import pytest
from synthetic import moved, standing, waving

from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.execution import execute
from motiondiffuse_ros.physics import assess
from motiondiffuse_ros.physics.tracking import SamplingConfig
from motiondiffuse_ros.planner import Planner, PlannerConfig
from motiondiffuse_ros.request import MotionRequest


def judge(motion):
    return assess(motion, track=False)


def test_what_was_executed_is_published_with_its_own_report():
    planned = waving(9)
    motion, report = execute(planned, judge(planned), publish=True, judge=judge)
    assert motion is not planned
    assert (motion.frames, motion.fps) == (planned.frames, planned.fps)
    np.testing.assert_allclose(motion.positions[0], planned.positions[0], atol=1e-6)
    assert report.metrics["execution_success"] == 1.0
    assert report.metrics["peak_jerk"] == judge(motion).metrics["peak_jerk"]


def test_what_cannot_be_executed_stays_as_planned_and_says_so():
    hovering = moved(standing(21), np.array([0.0, 0.0, 1.5]))
    motion, report = execute(
        hovering,
        judge(standing(21)),
        publish=True,
        judge=judge,
        sampling=SamplingConfig(directions=8, retries=0),
    )
    assert motion is hovering
    assert report.verdict == "marginal"
    assert "it falls at 0." in report.reasons[-1]
    assert report.metrics["execution_success"] == 0.0


def test_the_planner_executes_if_asked():
    config = PlannerConfig(steps=4, candidates=1, track=False, execution="verify")
    request = MotionRequest.from_text("a person stands still", 0.5, seed=3)
    fractions = []
    plan = Planner(config).plan(request, progress=lambda p: fractions.append(p.fraction))
    assert plan.report.metrics["execution_mpjpe_mm"] > 0.0
    assert fractions == sorted(fractions)


def test_an_unknown_execution_is_refused():
    with pytest.raises(RequestError, match="none, verify, publish_executed"):
        PlannerConfig(execution="always").validate()
