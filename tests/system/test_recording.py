"""A node that records: each plan in a file of its own, which gives the same plan again."""

import subprocess
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from ros_graph import ANSWER, FAST, START
from ros_operator import Operator
from ros_plans import goal, ignore, states

from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.msg import MotionPlan
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.recording import difference, planner_of, read_recording, replay
from motiondiffuse_ros.ros.processes import ros_arguments, running

pytestmark = pytest.mark.skipif(
    not (shipped_weights() / "config.json").is_file(), reason="no weights are shipped yet"
)


def planned(operator: Operator, text: str, length: float) -> MotionPlan:
    result = operator.generate(goal(text, length), ignore, ANSWER)
    assert result.error_code == ErrorCode.SUCCESS, result.message
    return result.plan


def mount(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["mount", *map(str, arguments)], capture_output=True, text=True)


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 KiB, less than any recording takes."""
    folder = tmp_path / "small disk"
    folder.mkdir()
    try:
        mounted = mount("-t", "tmpfs", "-o", "size=64k", "tmpfs", folder)
    except FileNotFoundError:
        pytest.skip("there is no `mount`")
    if mounted.returncode:
        pytest.skip(f"no leave to mount a file system: {mounted.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


def test_plans_are_recorded_and_where_they_cannot_be_they_are_published(graph):
    folder, blocked = graph / "recordings", graph / "blocked"
    blocked.write_text("not a folder")
    arguments = ros_arguments(**FAST, record_dir=folder)
    log = graph / "node.log"
    with (
        running("motiondiffuse_ros.ros.node", arguments, log) as process,
        Operator(lambda: process.poll() is None) as operator,
    ):
        operator.wait_for_node(START)
        plan = partial(planned, operator)
        # the second goes on from the first, which is still executed
        plans = [plan("a person walks forward", 30.0), plan("a person waves", 2.0)]
        assert operator.set("record_dir", str(blocked)) == ""
        assert plan("a person bows", 1.0).plan_id
        operator.wait(
            lambda: str(blocked) in operator.health.message, ANSWER, "a word on /diagnostics"
        )
        assert operator.health.level == DiagnosticStatus.WARN
        assert operator.set("record_dir", "") == ""
        plan("a person bows", 1.0)
        operator.wait(
            lambda: operator.health.level == DiagnosticStatus.OK, ANSWER, "the end of the problem"
        )
    assert f"recording {blocked}/" in log.read_text()

    files = {path.stem.partition("_")[2]: path for path in folder.iterdir()}
    assert set(files) == {plan.plan_id for plan in plans}
    first, second = (read_recording(files[plan.plan_id]) for plan in plans)
    assert first.origin.start.lead_in is None
    assert second.origin.start.lead_in is not None
    for message, record in zip(plans, (first, second), strict=True):
        points = [point.positions for point in message.trajectory.points]
        np.testing.assert_array_equal(points, record.trajectory["positions"])
    # in another process than the node's
    assert difference(second, replay(second, planner_of(second)).trajectory) == ""


def test_a_full_disk_hinders_no_plan_and_keeps_no_half_file(graph, small_disk):
    arguments = ros_arguments(**FAST, record_dir=small_disk)
    log = graph / "node.log"
    with (
        running("motiondiffuse_ros.ros.node", arguments, log) as process,
        Operator(lambda: process.poll() is None) as operator,
    ):
        operator.wait_for_node(START)
        plan = partial(planned, operator, "a person waves", 2.0)
        states(plan())  # checks what it promises
        operator.wait(
            lambda: "No space left on device" in operator.health.message,
            ANSWER,
            "a word on /diagnostics",
        )
        assert operator.health.level == DiagnosticStatus.WARN
        assert list(small_disk.iterdir()) == []
        # and once there is room again it records again
        assert mount("-o", "remount,size=64m", small_disk).returncode == 0
        recorded = plan()
        operator.wait(
            lambda: operator.health.level == DiagnosticStatus.OK, ANSWER, "the end of the problem"
        )
        (file,) = small_disk.iterdir()
        assert file.stem.endswith(f"_{recorded.plan_id}")
        read_recording(file)
    (line,) = (line for line in log.read_text().splitlines() if "cannot be written" in line)
    assert "No space left on device" in line
