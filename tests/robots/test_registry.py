"""Robots are found by name, and a description that is not complete is refused with the reason."""

from dataclasses import replace

import mujoco
import pytest

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.robots import available_robots, get_robot
from motiondiffuse_ros.robots.humanoid import describe_humanoid
from motiondiffuse_ros.robots.robot import load_robot


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(RobotError, match=r"unknown robot 'atlas'; the robots are g1, humanoid"):
        get_robot("atlas")
    assert {"humanoid", "g1"} <= set(available_robots())


def test_the_rest_stance_is_inside_the_limits():
    robot = get_robot("humanoid")
    assert (robot.lower < robot.rest_positions).all()
    assert (robot.rest_positions < robot.upper).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"speed_limits": {}}, "no speed limit"),
        ({"rest": {"third_arm": 0.0}}, "no joints"),
        (
            {"model": lambda: mujoco.MjModel.from_xml_string("<mujoco><worldbody/></mujoco>")},
            "free joint",
        ),
    ],
)
def test_an_incomplete_description_is_refused(change, words):
    with pytest.raises(RobotError, match=words):
        load_robot(replace(describe_humanoid(), **change))
