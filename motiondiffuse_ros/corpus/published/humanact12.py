"""HumanAct12 (github.com/EricGuo5513/action-to-motion).

A folder of `P01G01R01F0001T0064A0101.npy`: person, group, repetition, first and last frame, and
the action, whose first two digits are one of twelve classes and whose last two say which form of
it. Each holds the 24 SMPL joints [T, 24, 3], m, in the frame of a camera: y down, z away.

No split was published, so clips fall into splits by their names as ours do. The caption is the
class, as in the paper; the forms' labels hold sides that mirroring could not swap.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from motiondiffuse_ros.corpus.importer import on_floor
from motiondiffuse_ros.corpus.published.dataset import ImportedClip, PublishedDataset
from motiondiffuse_ros.corpus.published.files import read_array
from motiondiffuse_ros.corpus.published.smpl import UPSIDE_DOWN, camera_to_z_up, upside_down
from motiondiffuse_ros.corpus.quality import QualityConfig, reason_to_drop
from motiondiffuse_ros.corpus.split import split_of
from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.from_positions import motion_from_positions
from motiondiffuse_ros.motion.representations import JointPositions
from motiondiffuse_ros.motion.skeleton import CANONICAL

CLASSES = (
    *("warm up", "walk", "run", "jump", "drink", "lift dumbbell", "sit", "eat"),
    *("turn steering wheel", "phone", "boxing", "throw"),
)
_NAME = re.compile(r"P\d{2}G\d{2}R\d{2}F\d{4}T\d{4}A(\d{2})\d{2}")


@dataclass(frozen=True)
class HumanAct12(PublishedDataset):
    """The folder `HumanAct12`.

    Attributes:
        folder: Of the `.npy` files.
        quality: Limits beyond which clips are dropped.
    """

    folder: Path
    quality: QualityConfig = field(default_factory=QualityConfig)
    name: ClassVar[str] = "humanact12"
    fps: ClassVar[float] = 20.0
    representation: ClassVar[Representation] = JointPositions()

    def validate(self) -> None:
        """Raise CorpusError if there are no files, or one has another name."""
        if not self._files:
            raise CorpusError(f"{self.folder}: no .npy file; HumanAct12 has one for each clip")
        for file in self._files:
            _class_of(file)

    def __len__(self) -> int:
        """Return the number of files."""
        return len(self._files)

    def __iter__(self) -> Iterator[list[ImportedClip | str]]:
        """Read the files in the order of their names."""
        for file in self._files:
            yield [self._read(file)]

    @cached_property
    def _files(self) -> list[Path]:
        return sorted(self.folder.glob("*.npy"))

    def _read(self, file: Path) -> ImportedClip | str:
        captions = (_class_of(file),)
        joints = read_array(file, (24, 3))[:, : len(CANONICAL.names)].astype(float)
        if not np.isfinite(joints).all():
            return "not finite"
        try:
            motion = motion_from_positions(camera_to_z_up(joints), self.fps)
        except ValueError:
            return "joints coincide"
        if upside_down(motion):
            return UPSIDE_DOWN
        motion = on_floor(motion)
        reason = reason_to_drop(motion, captions, self.quality)
        if reason is not None:
            return reason
        split = split_of(self.name, file.stem)
        return ImportedClip(file.stem, split, captions, self.representation.encode(motion))


def _class_of(file: Path) -> str:
    match = _NAME.fullmatch(file.stem)
    number = int(match.group(1)) if match else 0
    if not 1 <= number <= len(CLASSES):
        raise CorpusError(
            f"{file}: not a name of HumanAct12, such as P01G01R01F0001T0064A0101.npy with an "
            f"action from A01 to A{len(CLASSES)}"
        )
    return CLASSES[number - 1]
