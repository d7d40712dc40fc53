"""Skeleton maps: YAML files that say how a data set's skeleton becomes the canonical one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from motiondiffuse_ros.errors import CorpusError, MotionFileError
from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array

_AXES = {
    f"{sign}{name}": (-1.0 if sign else 1.0) * np.eye(3)[i]
    for i, name in enumerate("XYZ")
    for sign in ("", "-")
}


@dataclass(frozen=True)
class SkeletonMap:
    """How one data set's joints follow the canonical ones; lengths scale by the legs.

    Attributes:
        name: Name of the data set or edition.
        joints: For each canonical joint the file's joint whose world rotation it takes, or two
            between which it lies halfway; canonical joints not named stay at zero rotation.
        t_pose: World rotation of the file's joints in the T-pose (wxyz, y up); identity if absent.
        follow_bones: Canonical joints that take the direction of the file's bone rather than the
            joint's frame, for files whose T-pose limbs are bent.
        find_floor: Whether the floor is estimated per clip; else it is at zero.
        skip_frames: Frames to drop at the start (calibration poses).
    """

    name: str
    joints: Mapping[str, tuple[str, ...]]
    t_pose: Mapping[str, Array] = field(default_factory=dict)
    follow_bones: tuple[str, ...] = ()
    find_floor: bool = True
    skip_frames: int = 0

    @property
    def required(self) -> frozenset[str]:
        """Joints that a file must have to be read with this map."""
        return frozenset(name for names in self.joints.values() for name in names)

    @classmethod
    def from_yaml(cls, path: Path) -> SkeletonMap:
        """Read a map.

        Raises:
            CorpusError: If the file is not such a map; the message names the key.
        """
        try:
            data = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
        except (OSError, yaml.YAMLError) as error:
            raise CorpusError(f"skeleton map {path}: cannot be read ({error})") from error
        try:
            return cls._from_dict(data)
        except (KeyError, TypeError, ValueError) as error:
            raise CorpusError(f"skeleton map {path}: {error}") from error

    @classmethod
    def _from_dict(cls, data: dict[str, Any]) -> SkeletonMap:
        known = {
            *("name", "joints", "t_pose", "t_pose_pitch"),
            *("follow_bones", "find_floor", "skip_frames"),
        }
        if unknown := set(data) - known:
            raise ValueError(f"unknown keys {sorted(unknown)}; the keys are {sorted(known)}")
        joints = {
            joint: (names,) if isinstance(names, str) else tuple(names)
            for joint, names in data["joints"].items()
        }
        if unknown := set(joints) - set(CANONICAL.names):
            raise ValueError(
                f"unknown canonical joints {sorted(unknown)}; they are {', '.join(CANONICAL.names)}"
            )
        if missing := {"pelvis", *_LEGS} - set(joints):
            raise ValueError(f"the joints {sorted(missing)} must be mapped")
        pitch = data.get("t_pose_pitch", {})
        t_pose = {
            name: rot.multiply(
                rot.about_axis(0, np.radians(pitch.get(name, 0.0))),
                rot.from_matrix(np.stack([_AXES[axis] for axis in axes], axis=-1)),
            )
            for name, axes in data.get("t_pose", {}).items()
        }
        return cls(
            name=data["name"],
            joints=joints,
            t_pose=t_pose,
            follow_bones=tuple(data.get("follow_bones", ())),
            find_floor=bool(data.get("find_floor", True)),
            skip_frames=int(data.get("skip_frames", 0)),
        )


_LEGS = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle"))


def shipped_skeleton_maps() -> tuple[SkeletonMap, ...]:
    """Return the maps that come with the package."""
    folder = files("motiondiffuse_ros.corpus") / "skeleton_maps"
    paths = sorted(Path(str(entry)) for entry in folder.iterdir() if entry.name.endswith(".yaml"))
    return tuple(SkeletonMap.from_yaml(path) for path in paths)


def match_skeleton_map(
    joints: Iterable[str], path: Path, maps: Iterable[SkeletonMap]
) -> SkeletonMap:
    """Return the map whose joints a file has.

    Raises:
        MotionFileError: If no map fits; the message lists the maps and what each misses.
    """
    present = set(joints)
    misses: list[str] = []
    for skeleton_map in maps:
        absent = skeleton_map.required - present
        if not absent:
            return skeleton_map
        misses.append(f"{skeleton_map.name} ({len(absent)} of its joints absent)")
    raise MotionFileError(
        f"{path}: no skeleton map fits its {len(present)} joints; known: {', '.join(misses)}; "
        "write a YAML map like those in motiondiffuse_ros/corpus/skeleton_maps"
    )
