"""Robots by name."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.robots.humanoid import describe_humanoid
from motiondiffuse_ros.robots.robot import Robot, RobotDescription, load_robot

_DESCRIPTIONS: dict[str, Callable[[], RobotDescription]] = {"humanoid": describe_humanoid}


def available_robots() -> tuple[str, ...]:
    """Return the names that `get_robot` takes."""
    return tuple(sorted(_DESCRIPTIONS))


def get_robot(name: str) -> Robot:
    """Return a robot; loaded once a process.

    Raises:
        RobotError: If there is none of that name.
    """
    if name not in _DESCRIPTIONS:
        raise RobotError(f"unknown robot '{name}'; the robots are {', '.join(available_robots())}")
    return _load(name)


@cache
def _load(name: str) -> Robot:
    return load_robot(_DESCRIPTIONS[name]())
