"""Configure, activate and their failures; parameters; clean ends."""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from lifecycle_msgs.msg import State, Transition
from ros_graph import ANSWER, FAST, START
from ros_operator import Operator
from ros_plans import goal

from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.msg import MotionRequest
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.ros.client import MotionClient
from motiondiffuse_ros.ros.processes import ros_arguments, running

MODULE = "motiondiffuse_ros.ros.node"
WALK = goal("a person walks", 1.0)

pytestmark = pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)


@contextmanager
def unconfigured(graph: Path, **parameters) -> Iterator[Operator]:
    arguments = ros_arguments(autostart=False, **FAST, **parameters)
    with running(MODULE, arguments, graph / "lifecycle.log"), Operator() as operator:
        yield operator


def checkpoint(folder: Path, name: str) -> Path:
    """A checkpoint with something wrong."""
    path = folder / name.replace(" ", "_")
    if name == "missing":
        return path
    shutil.copytree(shipped_weights(), path)
    model = path / "model.safetensors"
    if name == "truncated":
        model.write_bytes(model.read_bytes()[:1000])
    elif name == "altered":
        content = bytearray(model.read_bytes())
        content[-1] ^= 1
        model.write_bytes(content)
    elif name == "without config":
        (path / "config.json").unlink()
    elif name == "of another kind":
        (path / "config.json").write_text("[1, 2]")
    return path


def test_bad_weights_fail_with_the_reason_and_good_ones_work_afterwards(graph, tmp_path):
    with unconfigured(graph, weights=checkpoint(tmp_path, "missing")) as operator:
        for name in ("missing", "truncated", "altered", "without config", "of another kind"):
            path = checkpoint(tmp_path, name) if name != "missing" else tmp_path / name
            assert operator.set("weights", str(path)) == ""
            assert not operator.change(Transition.TRANSITION_CONFIGURE), name
            assert operator.state() == State.PRIMARY_STATE_UNCONFIGURED
            operator.wait(lambda p=path: str(p) in operator.health.message, ANSWER, "the reason")
            assert operator.health.level == DiagnosticStatus.ERROR

        assert operator.set("weights", "") == ""
        assert operator.change(Transition.TRANSITION_CONFIGURE)
        assert operator.state() == State.PRIMARY_STATE_INACTIVE
        assert operator.change(Transition.TRANSITION_ACTIVATE)
        operator.wait(lambda: operator.health.message == "ready", ANSWER, "its health")
        operator.wait_for_node(ANSWER)
        assert operator.change(Transition.TRANSITION_DEACTIVATE)
        result = operator.generate(WALK, lambda feedback: None, ANSWER)
        assert result.error_code == ErrorCode.NOT_ACTIVE
        assert "activate" in result.message

        assert operator.change(Transition.TRANSITION_ACTIVATE)
        assert operator.generate(WALK, lambda feedback: None, ANSWER).error_code == 0


def test_deactivation_ends_the_goal_in_work_and_the_cycle_can_start_again(graph):
    with unconfigured(graph) as operator:
        for _ in range(2):
            assert operator.change(Transition.TRANSITION_CONFIGURE)
            assert operator.change(Transition.TRANSITION_ACTIVATE)
            operator.wait_for_node(ANSWER)
            feedback: list = []
            goal = MotionRequest(segments=WALK.segments, steps=1000)
            handle = operator.send(goal, feedback.append, ANSWER)
            operator.wait(lambda: bool(feedback), ANSWER, "feedback")  # noqa: B023
            assert operator.change(Transition.TRANSITION_DEACTIVATE)
            result = operator.result(handle, ANSWER)
            assert result.error_code == ErrorCode.NOT_ACTIVE
            assert operator.change(Transition.TRANSITION_CLEANUP)
            assert operator.state() == State.PRIMARY_STATE_UNCONFIGURED


def test_wrong_parameters_are_refused_with_what_would_be_right(graph):
    with unconfigured(graph) as operator:
        assert "range" in operator.set("steps", 0)
        assert "range" in operator.set("candidates", 10**6)
        assert "range" in operator.set("control_rate", -1.0)
        assert "ddim, ddpm" in operator.set("scheduler", "euler")
        assert "humanoid" in operator.set("robot", "robby")
        assert operator.set("guidance_scale", float("nan")) != ""
        assert operator.set("steps", "many") != ""
        assert operator.set("steps", 12) == ""
        assert operator.change(Transition.TRANSITION_CONFIGURE)
        assert "after cleanup" in operator.set("control_rate", 100.0)
        assert operator.set("steps", 13) == ""


def test_a_wrong_parameter_at_start_ends_the_process_with_one_line(graph):
    run = subprocess.run(
        [sys.executable, "-m", MODULE, *ros_arguments(scheduler="euler")],
        capture_output=True,
        text=True,
        env=dict(os.environ),
    )
    assert run.returncode == 2
    assert "ddim, ddpm" in run.stderr
    assert "Traceback" not in run.stderr


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM], ids=lambda s: s.name)
def test_signals_end_it_cleanly_even_at_work_and_the_client_is_told(graph, how):
    log = graph / "signal.log"
    with running(MODULE, ros_arguments(**FAST), log) as process, MotionClient() as client:
        client.wait_for_node(START)
        feedback: list = []
        goal = MotionRequest(segments=WALK.segments, steps=1000)
        handle = client.send(goal, feedback.append, ANSWER)
        client.wait(lambda: bool(feedback), ANSWER, "feedback")
        result = handle.get_result_async()
        process.send_signal(how)
        client.wait(result.done, ANSWER, "the result")
        answer = result.result()
        assert answer is not None
        assert answer.result.error_code == ErrorCode.NOT_ACTIVE
        assert process.wait(ANSWER) == 0
    assert "Traceback" not in log.read_text()
