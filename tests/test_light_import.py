import subprocess
import sys

import pytest

from motiondiffuse_ros.light_import import without_compiler


def _said(code: str) -> str:
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=300
    )
    return ended.stdout.strip()


@pytest.mark.parametrize("module", ["motiondiffuse_ros.planner", "motiondiffuse_ros.ros.node"])
def test_what_plans_does_not_load_the_compiler(module):
    assert _said(f"import sys, {module}; print('torch._dynamo' in sys.modules)") == "False"


def test_who_wants_the_compiler_later_gets_it():
    code = "import motiondiffuse_ros.planner, torch; print(torch.compile(abs, backend='eager')(-2))"
    assert _said(code) == "2"


def test_a_compiler_that_is_there_stays(monkeypatch):
    there = object()
    monkeypatch.setitem(sys.modules, "torch._dynamo", there)
    with without_compiler():
        assert sys.modules["torch._dynamo"] is there
    assert sys.modules["torch._dynamo"] is there


def test_what_fails_leaves_nothing_behind(monkeypatch):
    monkeypatch.delitem(sys.modules, "torch._dynamo", raising=False)
    with pytest.raises(ValueError, match="no import"), without_compiler():
        raise ValueError("no import")
    assert "torch._dynamo" not in sys.modules
