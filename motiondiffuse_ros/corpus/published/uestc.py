"""UESTC with the SMPL poses that ACTOR's authors published (github.com/Mathux/ACTOR).

    vibe_cache_refined.pkl      lists by clip: pose [T, 72] rotation vectors, joints3d [T, 49, 3] m,
                                orig_cam [T, 4]; in the frame of a camera, y down
    info/names.txt              clips, aA_dD_pPPP_cC_color.avi: action, view, person, camera
    info/action_classes.txt     the classes' names
    info/num_frames_min.txt     frames that each clip has at least

The split is that of persons: 51 train, all others test. Clips of the second camera in the view
that has no direction (d8) are left out, as ACTOR does; what else it turns to the front needs no
turning here, because the first frame always faces ahead.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from motiondiffuse_ros.corpus.importer import on_floor
from motiondiffuse_ros.corpus.published.dataset import ImportedClip, PublishedDataset
from motiondiffuse_ros.corpus.published.files import check_frames, read_lines, require
from motiondiffuse_ros.corpus.published.plain_pickle import read_plain_pickle
from motiondiffuse_ros.corpus.published.smpl import (
    FROM_CAMERA,
    UPSIDE_DOWN,
    motion_from_smpl,
    upside_down,
)
from motiondiffuse_ros.corpus.quality import QualityConfig, reason_to_drop
from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.representations import RootRotations
from motiondiffuse_ros.motion.rotations import Array

TRAINING_PERSONS = frozenset(
    (
        *(1, 2, 6, 12, 13, 16, 21, 24, 28, 29, 30, 31, 33, 35, 39, 41, 42, 45, 47, 50, 52, 54),
        *(55, 57, 59, 61, 63, 64, 67, 69, 70, 71, 73, 77, 81, 84, 86, 87, 88, 90, 91, 93, 96),
        *(99, 102, 103, 104, 107, 108, 112, 113),
    )
)
_PERSONS = 118
_NAME = re.compile(r"a(\d+)_d(\d+)_p(\d+)_c(\d+)_color\.avi")
_POSES = "vibe_cache_refined.pkl"
_SHAPES = {"pose": (72,), "joints3d": (49, 3), "orig_cam": (4,)}
_MID_HIP = 8  # of VIBE's 49 joints, of which the first 25 are OpenPose's
_FOCAL_LENGTH, _IMAGE_SIZE = 500.0, 540.0
_ALL_ROUND_VIEW, _FRONT_CAMERA = 8, 1


@dataclass(frozen=True)
class Uestc(PublishedDataset):
    """The folder `uestc`.

    Attributes:
        folder: As above.
        quality: Limits beyond which clips are dropped.
    """

    folder: Path
    quality: QualityConfig = field(default_factory=QualityConfig)
    name: ClassVar[str] = "uestc"
    fps: ClassVar[float] = 30.0
    representation: ClassVar[Representation] = RootRotations()

    def validate(self) -> None:
        """Raise CorpusError if files are missing or do not fit each other."""
        require(self.folder / _POSES, "ACTOR's uestc archive has it")
        frames = self._frames
        if len(frames) != len(self._names):
            raise CorpusError(
                f"{self.folder / 'info'}: num_frames_min.txt has {len(frames)} lines, names.txt "
                f"{len(self._names)}; expected as many"
            )
        for name in self._names:
            self._parse(name)

    def __len__(self) -> int:
        """Return the number of clips listed."""
        return len(self._names)

    def __iter__(self) -> Iterator[list[ImportedClip | str]]:
        """Go through the clips in the order of the list."""
        poses = self._read_poses()
        for i, name in enumerate(self._names):
            yield [self._read(i, name, poses)]

    @cached_property
    def _names(self) -> list[str]:
        return read_lines(self.folder / "info" / "names.txt", "it lists the clips, one a line")

    @cached_property
    def _classes(self) -> list[str]:
        path = self.folder / "info" / "action_classes.txt"
        return read_lines(path, "it names the classes, one a line")

    @cached_property
    def _frames(self) -> list[int]:
        path = self.folder / "info" / "num_frames_min.txt"
        lines = read_lines(path, "it holds the frames of each clip, one number a line")
        try:
            return [int(line) for line in lines]
        except ValueError as error:
            raise CorpusError(f"{path}: expected one number a line ({error})") from error

    def _parse(self, name: str) -> tuple[int, int, int, int]:
        match = _NAME.fullmatch(name)
        if match is None:
            raise CorpusError(
                f"{self.folder / 'info' / 'names.txt'}: '{name}' is not a name such as "
                "a0_d1_p001_c1_color.avi"
            )
        action, view, person, camera = map(int, match.groups())
        if action >= len(self._classes) or not 1 <= person <= _PERSONS:
            raise CorpusError(
                f"{self.folder / 'info' / 'names.txt'}: '{name}' is of no known class or person; "
                f"there are {len(self._classes)} classes and persons 1 to {_PERSONS}"
            )
        return action, view, person, camera

    def _read_poses(self) -> dict[str, Any]:
        path = self.folder / _POSES
        expected = f"expected lists by clip under {', '.join(_SHAPES)}"
        data = read_plain_pickle(path, expected)
        if not isinstance(data, dict) or not _SHAPES.keys() <= data.keys():
            raise CorpusError(f"{path}: {expected}")
        for key in _SHAPES:
            if not isinstance(data[key], list | np.ndarray) or len(data[key]) != len(self):
                raise CorpusError(f"{path}: {key} is not a list of {len(self)}, as names.txt has")
        return data

    def _read(self, i: int, name: str, poses: dict[str, Any]) -> ImportedClip | str:
        action, view, person, camera = self._parse(name)
        if view == _ALL_ROUND_VIEW and camera != _FRONT_CAMERA:
            return "view without a direction"
        where = f"{self.folder / _POSES}: clip {i} ({name})"
        pose, joints, camera_of = (
            check_frames(poses[key][i], shape, f"{where}, {key}")[: self._frames[i]].astype(float)
            for key, shape in _SHAPES.items()
        )
        if not len(pose) == len(joints) == len(camera_of) > 0:
            raise CorpusError(f"{where}: {', '.join(_SHAPES)} differ in length or are empty")
        if not all(np.isfinite(a).all() for a in (pose, joints, camera_of)):
            return "not finite"
        path = joints[:, _MID_HIP] + _camera_path(camera_of)
        motion = motion_from_smpl(pose, path, FROM_CAMERA, self.fps)
        if upside_down(motion):
            return UPSIDE_DOWN
        motion = on_floor(motion)
        captions = (self._classes[action].replace("_", " ").replace("-", " "),)
        reason = reason_to_drop(motion, captions, self.quality)
        if reason is not None:
            return reason
        split = "train" if person in TRAINING_PERSONS else "test"
        features = self.representation.encode(motion)
        return ImportedClip(name.removesuffix("_color.avi"), split, captions, features)


def _camera_path(camera: Array) -> Array:
    """Return where the body is before the camera [T, 3], m, from VIBE's (scale, -, x, y)."""
    depth = _FOCAL_LENGTH / (0.5 * _IMAGE_SIZE * camera[:, 0])
    return np.stack([camera[:, 2], camera[:, 3], depth], axis=-1)
