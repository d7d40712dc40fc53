"""Robots described by a YAML file beside their MJCF. The file holds names and numbers, no code."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from importlib.resources import files
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.input_file import load_yaml
from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.robots.model_search import find_model
from motiondiffuse_ros.robots.robot import RobotDescription, standing_on_floor
from motiondiffuse_ros.robots.scene import add_floor

NEEDED = (
    "pelvis",
    "spine3",
    *(
        f"{side}_{joint}"
        for side in ("left", "right")
        for joint in ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")
    ),
)
"""Canonical joints that a description has to map."""

_FIELDS = ("model", "bodies", "t_pose", "rest", "speed_limits")
_Point = tuple[str, tuple[float, float, float]]


@dataclass(frozen=True)
class DescriptionFile:
    """What a YAML file says of a robot.

    Attributes:
        path: Of the file.
        model: MJCF, as `find_model` takes it.
        bodies: For each canonical joint the body that follows it, and the point in that body's
            frame that stands for the joint [m].
        t_pose: Joint positions of the canonical T-pose, rad; others are 0.
        rest: Joint positions of an upright stance, rad; others are 0.
        speed_limits: Largest joint speeds, rad/s, by name or pattern.
    """

    path: Path
    model: str
    bodies: Mapping[str, _Point] = field(repr=False)
    t_pose: Mapping[str, float] = field(repr=False)
    rest: Mapping[str, float] = field(repr=False)
    speed_limits: Mapping[str, float] = field(repr=False)

    @classmethod
    def read(cls, path: Path) -> DescriptionFile:
        """Read a description.

        Raises:
            RobotError: If the file cannot be read or a field is missing, unknown or wrong; names
                file and field and says what would be right.
        """
        try:
            data = load_yaml(path, RobotError)
        except (OSError, RobotError) as error:
            line = " ".join(str(error).split())
            raise RobotError(f"{path}: cannot be read as a robot description ({line})") from error
        try:
            return cls._from_dict(path, data)
        except ValueError as error:
            raise RobotError(f"{path}: {error}") from error

    @classmethod
    def _from_dict(cls, path: Path, data: Any) -> DescriptionFile:
        if not isinstance(data, dict):
            raise ValueError(f"must be a mapping with the fields {', '.join(_FIELDS)}")
        if unknown := [str(key) for key in data if key not in _FIELDS]:
            raise ValueError(f"unknown field '{unknown[0]}'; the fields are {', '.join(_FIELDS)}")
        model = data.get("model")
        if not isinstance(model, str) or not model.strip():
            raise ValueError(f"model must be a file such as unitree_g1/g1.xml, got {model!r}")
        speeds = _numbers(data, "speed_limits")
        if slow := [name for name, speed in speeds.items() if speed <= 0.0]:
            raise ValueError(f"speed_limits.{slow[0]} must be above 0 rad/s, got {speeds[slow[0]]}")
        return cls(
            path=path,
            model=model.strip(),
            bodies=_bodies(data.get("bodies")),
            t_pose=_numbers(data, "t_pose"),
            rest=_numbers(data, "rest"),
            speed_limits=speeds,
        )

    def describe(self, name: str) -> RobotDescription:
        """Return the description of a robot of a name, its model compiled.

        Raises:
            RobotError: If there is no model, or it does not fit the file.
        """
        model = self._compile(find_model(self.model, self.path.parent))
        joints = [model.joint(j).name for j in range(1, model.njnt)]
        for key, table in (("t_pose", self.t_pose), ("rest", self.rest)):
            if unknown := [name for name in table if name not in joints]:
                raise self._error(f"{key}: no joint '{unknown[0]}'; they are {', '.join(joints)}")
        limits = {}
        for pattern, speed in self.speed_limits.items():
            named = [joint for joint in joints if fnmatchcase(joint, pattern)]
            if not named:
                raise self._error(
                    f"speed_limits: '{pattern}' names no joint; they are {', '.join(joints)}"
                )
            limits.update(dict.fromkeys(named, speed))
        standing_on_floor(model, np.array([self.rest.get(joint, 0.0) for joint in joints]))
        return RobotDescription(
            name=name,
            model=lambda: model,
            speed_limits=limits,
            rest=self.rest,
            body_map={name: site_name(name) for name in self.bodies},
            retargeting="ik",
            t_pose=self.t_pose,
        )

    def _compile(self, path: Path) -> mujoco.MjModel:
        try:
            spec = mujoco.MjSpec.from_file(str(path))
            names = [body.name for body in spec.bodies if body.name != "world"]
            for joint, (body, point) in self.bodies.items():
                if body not in names:
                    raise self._error(
                        f"bodies.{joint}: no body '{body}' in {path}; they are {', '.join(names)}"
                    )
                spec.body(body).add_site(name=site_name(joint), pos=point, size=[0.005] * 3)
            add_floor(spec)
            return spec.compile()
        except ValueError as error:
            raise self._error(f"model {path} does not compile ({error})") from error

    def _error(self, words: str) -> RobotError:
        return RobotError(f"{self.path}: {words}")


def site_name(joint: str) -> str:
    """Return the name of the site that stands for a canonical joint in a robot's model."""
    return f"canonical/{joint}"


def shipped_descriptions() -> dict[str, Path]:
    """Return the descriptions that come with the package, by name."""
    folder = Path(str(files("motiondiffuse_ros.robots") / "descriptions"))
    return {path.stem: path for path in sorted(folder.glob("*.yaml"))}


def _bodies(data: Any) -> dict[str, _Point]:
    if not isinstance(data, dict):
        raise ValueError(f"bodies must map canonical joints to bodies, got {data!r}")
    if unknown := [str(key) for key in data if key not in CANONICAL.names]:
        known = ", ".join(CANONICAL.names)
        raise ValueError(f"bodies: unknown canonical joint '{unknown[0]}'; they are {known}")
    if missing := [name for name in NEEDED if name not in data]:
        raise ValueError(f"bodies: {missing[0]} is missing; needed are {', '.join(NEEDED)}")
    return {joint: _point(value, f"bodies.{joint}") for joint, value in data.items()}


def _point(value: Any, where: str) -> _Point:
    if isinstance(value, str):
        return value, (0.0, 0.0, 0.0)
    if isinstance(value, list) and len(value) == 4 and isinstance(value[0], str):
        x, y, z = (_number(v, where) for v in value[1:])
        return value[0], (x, y, z)
    raise ValueError(f"{where} must be a body or [body, x, y, z] with metres, got {value!r}")


def _numbers(data: dict[str, Any], key: str) -> dict[str, float]:
    table = data.get(key) or {}
    if not isinstance(table, dict):
        raise ValueError(f"{key} must map joints to numbers, got {table!r}")
    return {str(name): _number(value, f"{key}.{name}") for name, value in table.items()}


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError(f"{where} must be a finite number, got {value!r}")
    return float(value)
