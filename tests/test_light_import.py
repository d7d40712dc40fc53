import subprocess
import sys

import pytest

from motiondiffuse_ros.light_import import light_import


def _said(code: str) -> str:
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=300
    )
    return ended.stdout.strip()


@pytest.mark.parametrize("module", ["motiondiffuse_ros.planner", "motiondiffuse_ros.ros.node"])
def test_what_plans_loads_neither_compiler_nor_statistics(module):
    code = f"import sys, {module}; print({{'torch._dynamo', 'scipy.stats'}} & set(sys.modules))"
    assert _said(code) == "set()"


def test_planning_does_not_load_the_compiler():
    code = (
        "import sys; from motiondiffuse_ros.planner import MotionRequest, Planner, PlannerConfig; "
        "Planner(PlannerConfig(steps=4)).plan(MotionRequest.from_text('a person bows', 2.0)); "
        "print('torch._dynamo' in sys.modules)"
    )
    assert _said(code) == "False"


def test_who_wants_the_compiler_later_gets_it():
    code = "import motiondiffuse_ros.planner, torch; print(torch.compile(abs, backend='eager')(-2))"
    assert _said(code) == "2"


def test_who_wants_statistics_later_gets_them():
    code = "import motiondiffuse_ros.planner, scipy.stats; print(scipy.stats.norm.cdf(0.0))"
    assert _said(code) == "0.5"


def test_a_schedule_that_needs_statistics_has_them():
    code = (
        "import motiondiffuse_ros.planner; "
        "from diffusers.schedulers.scheduling_dpmsolver_multistep import "
        "DPMSolverMultistepScheduler as Solver; "
        "Solver(use_beta_sigmas=True).set_timesteps(4); print('set')"
    )
    assert _said(code) == "set"


def test_a_compiler_that_is_there_stays(monkeypatch):
    there = object()
    monkeypatch.setitem(sys.modules, "torch._dynamo", there)
    with light_import():
        assert sys.modules["torch._dynamo"] is there
    assert sys.modules["torch._dynamo"] is there


def test_what_fails_leaves_nothing_behind(monkeypatch):
    monkeypatch.delitem(sys.modules, "torch._dynamo", raising=False)
    with pytest.raises(ValueError, match="no import"), light_import():
        raise ValueError("no import")
    assert "torch._dynamo" not in sys.modules
