"""Nodes that are killed, have bad weights, or are configured again and again."""

from __future__ import annotations

import json
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest
import torch
from diagnostic_msgs.msg import DiagnosticStatus
from lifecycle_msgs.msg import State, Transition
from ros_graph import ANSWER, FAST, START
from ros_operator import Operator
from ros_plans import goal, ignore
from small_denoiser import SMALL

from benchmarks.soak import resident_bytes
from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.msg import MotionPlan, MotionRequest
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.ros.client import Feedback, MotionClient, Unreachable
from motiondiffuse_ros.ros.processes import ros_arguments, running
from motiondiffuse_ros.ros.qos import LATCHED
from motiondiffuse_ros.text import load_text_encoder

MODULE = "motiondiffuse_ros.ros.node"
WALK = goal("a person walks", 1.0)

pytestmark = pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)


def small_weights(folder: Path) -> Path:
    """Write a tiny model of random weights for the shipped text encoder."""
    torch.manual_seed(0)
    dim = SMALL.feature_dim
    statistics = Statistics(np.zeros(dim, "f"), np.ones(dim, "f"))
    encoder = load_text_encoder(SMALL.text_encoder)
    Checkpoint(Denoiser(SMALL), statistics, encoder.sha256).save_pretrained(folder)
    return folder


def test_a_node_that_is_killed_at_work_and_started_again(graph):
    long = MotionRequest(segments=WALK.segments, steps=1000)
    plans: list[MotionPlan] = []
    with MotionClient() as client:
        client.node.create_subscription(MotionPlan, "/motiondiffuse/plan", plans.append, LATCHED)
        with running(MODULE, ros_arguments(**FAST), graph / "first.log") as process:
            client.wait_for_node(START)
            feedback: list[Feedback] = []
            handle = client.send(long, feedback.append, ANSWER)
            client.wait(lambda: bool(feedback), ANSWER, "feedback")
            process.send_signal(signal.SIGKILL)
            process.wait(ANSWER)
            with pytest.raises(Unreachable, match=r"no sign of the result for 0\.5 s"):
                client.result(handle, 0.5)
        with (
            running(MODULE, ros_arguments(**FAST), graph / "second.log") as process,
            # the first client has yet to learn that the dead node is gone
            MotionClient(lambda: process.poll() is None) as fresh,
        ):
            fresh.wait_for_node(START)
            result = fresh.generate(WALK, ignore, ANSWER)
            assert result.error_code == ErrorCode.SUCCESS
            client.wait(lambda: bool(plans), ANSWER, "a plan for who was there before")
            assert plans[-1].plan_id == result.plan.plan_id


def test_a_model_that_gives_nothing_but_nan(graph, tmp_path):
    weights = small_weights(tmp_path / "nan")
    checkpoint = Checkpoint.from_pretrained(weights)
    with torch.no_grad():
        for parameter in checkpoint.denoiser.parameters():
            parameter.fill_(torch.nan)
    checkpoint.save_pretrained(weights)
    log = graph / "node.log"
    plans: list[MotionPlan] = []
    arguments = ros_arguments(**FAST, weights=weights)
    with running(MODULE, arguments, log) as process, Operator() as operator:
        operator.node.create_subscription(MotionPlan, "/motiondiffuse/plan", plans.append, LATCHED)
        operator.wait_for_node(START)
        for _ in range(2):
            result = operator.generate(WALK, ignore, ANSWER)
            assert result.error_code == ErrorCode.SAMPLING_FAILED
            assert "not finite" in result.message
            assert not result.plan.trajectory.points
        operator.wait(lambda: "not finite" in operator.health.message, ANSWER, "its health")
        assert plans == []
        assert process.poll() is None
    assert "Traceback" not in log.read_text()


def test_200_cycles_of_configure_and_cleanup_and_weights_of_the_wrong_shape(graph, tmp_path):
    good = small_weights(tmp_path / "good")
    wrong = tmp_path / "wrong"
    shutil.copytree(good, wrong)
    config = json.loads((wrong / "config.json").read_text())
    config["denoiser"]["ffn_width"] *= 2
    (wrong / "config.json").write_text(json.dumps(config))

    arguments = ros_arguments(**FAST, autostart=False, weights=wrong)
    with (
        running(MODULE, arguments, graph / "node.log") as process,
        Operator(lambda: process.poll() is None) as operator,
    ):
        assert not operator.change(Transition.TRANSITION_CONFIGURE)
        operator.wait(lambda: "does not fit" in operator.health.message, ANSWER, "the reason")
        assert operator.health.level == DiagnosticStatus.ERROR
        assert "\n" not in operator.health.message

        assert operator.set("weights", str(good)) == ""
        memory = []
        for _ in range(200):
            assert operator.change(Transition.TRANSITION_CONFIGURE)
            assert operator.change(Transition.TRANSITION_CLEANUP)
            memory.append(resident_bytes(process.pid))
        # Single figures differ by 100 MB, by how much the C library keeps of what was freed. What
        # cycles lose adds up: 1 MB in each would be 50 MB at least.
        assert min(memory[150:]) - max(memory[50:100]) < 20e6
        assert operator.state() == State.PRIMARY_STATE_UNCONFIGURED
        assert operator.change(Transition.TRANSITION_CONFIGURE)
        assert operator.change(Transition.TRANSITION_ACTIVATE)
        operator.wait_for_node(ANSWER)
        assert operator.generate(WALK, ignore, ANSWER).error_code == ErrorCode.SUCCESS
