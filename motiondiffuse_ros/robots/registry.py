"""Robots by name, or by the path of a description."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.input_file import is_file
from motiondiffuse_ros.robots.description_file import DescriptionFile, shipped_descriptions
from motiondiffuse_ros.robots.humanoid import describe_humanoid
from motiondiffuse_ros.robots.robot import Robot, load_robot

HUMANOID = "humanoid"


def available_robots() -> tuple[str, ...]:
    """Return the names that `get_robot` takes."""
    return tuple(sorted((HUMANOID, *shipped_descriptions())))


def robot_refusal(name: str) -> str:
    """Return why a robot cannot be had, without loading it; empty if nothing speaks against it."""
    if name in available_robots():
        return ""
    if not _is_path(name):
        known = ", ".join(available_robots())
        return f"unknown robot '{name}'; the robots are {known}, or the path of a YAML description"
    if not is_file(_path(name)):
        return f"no robot description at {name}; it is a YAML file as docs/robots.md shows"
    return ""


def get_robot(name: str) -> Robot:
    """Return a robot; loaded once a process. It has the name by which it was asked for.

    Args:
        name: One of `available_robots()`, or the path of a description (.yaml or .yml).

    Raises:
        RobotError: If there is none of that name, its description is wrong, or its model is not
            on this machine.
    """
    if refusal := robot_refusal(name):
        raise RobotError(refusal)
    return _load(str(_path(name).resolve()) if _is_path(name) else name)


@cache
def _load(name: str) -> Robot:
    if name == HUMANOID:
        return load_robot(describe_humanoid())
    path = Path(name) if _is_path(name) else shipped_descriptions()[name]
    return load_robot(DescriptionFile.read(path).describe(name))


def _path(name: str) -> Path:
    try:
        return Path(name).expanduser()
    except RuntimeError:  # the home of somebody who has none
        return Path(name)


def _is_path(name: str) -> bool:
    return name.endswith((".yaml", ".yml"))
