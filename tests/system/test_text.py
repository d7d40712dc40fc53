"""Words in, a joint trajectory out, for a program that knows nothing of this package."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from motiondiffuse_ros.robots import get_robot


def _answer(text):
    script = Path(__file__).with_name("text_publisher.py")
    run = subprocess.run(
        [sys.executable, str(script), text],
        check=True,
        capture_output=True,
        text=True,
        cwd="/",
    )
    return {key: np.array(value) for key, value in json.loads(run.stdout).items()}


def _lasts(trajectory, seconds):
    # docs/robots.md: what ends in mid-step comes to stand in 1.5 s more
    end = trajectory["times"][-1]
    return min(abs(end - seconds), abs(end - seconds - 1.5)) < 0.5


@pytest.fixture(scope="module")
def trajectory(node):
    return _answer("a person walks forward")


def test_it_names_the_63_joints_of_the_humanoid(trajectory):
    assert tuple(trajectory["names"]) == get_robot("humanoid").joint_names
    assert len(set(trajectory["names"])) == 63


def test_times_increase_strictly_to_the_length_of_a_sentence(trajectory):
    assert trajectory["times"][0] == 0.0
    assert (np.diff(trajectory["times"]) > 0.0).all()
    assert _lasts(trajectory, 6.0)


def test_positions_and_velocities_are_finite_and_inside_the_limits(trajectory):
    robot = get_robot("humanoid")
    positions, velocities = trajectory["positions"], trajectory["velocities"]
    assert np.isfinite(positions).all()
    assert np.isfinite(velocities).all()
    assert (positions >= robot.lower - 1e-9).all()
    assert (positions <= robot.upper + 1e-9).all()
    assert (np.abs(velocities) <= robot.velocity_limits + 1e-9).all()


def test_it_moves_and_ends_at_rest(trajectory):
    assert np.ptp(trajectory["positions"], axis=0).max() > 0.1
    assert not trajectory["velocities"][-1].any()


def test_a_typed_timeline_has_its_own_length(node):
    text = "[0-1.5] a person walks forward | [1.5-3] turns left | head[1-3]: nods"
    assert _lasts(_answer(text), 3.0)
