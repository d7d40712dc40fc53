"""The layout that HumanML3D and KIT-ML share.

    train.txt val.txt test.txt     names, one a line; names that start with M are mirror images
    new_joint_vecs/NAME.npy        features [T, 263] or [T, 251]
    texts/NAME.txt                 lines `caption#word/TAG word/TAG ...#start#end`, s; 0.0 and 0.0
                                   or nan for the whole clip

Mirror images are left out, of every split: training mirrors clips and captions itself. Lengths
are held to the limits of the published loader.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from motiondiffuse_ros.corpus.published.dataset import ImportedClip, PublishedDataset
from motiondiffuse_ros.corpus.published.files import read_array, read_lines, require
from motiondiffuse_ros.corpus.split import SPLITS
from motiondiffuse_ros.errors import CorpusError

_MAX_FRAMES = 199
_MIRRORED = "M"


@dataclass(frozen=True)
class GuoFolder(PublishedDataset):
    """A folder in this layout.

    Attributes:
        folder: With the split files, `new_joint_vecs` and `texts`.
    """

    folder: Path
    min_frames: ClassVar[int]

    def validate(self) -> None:
        """Raise CorpusError if files are missing or no listed clip is there."""
        for part in ("new_joint_vecs", "texts"):
            if not (self.folder / part).is_dir():
                raise CorpusError(
                    f"{self.folder / part}: missing; {self.name} has a folder of that name "
                    "(unpack its archive beside the split files)"
                )
        if not any(self._features_file(name).exists() for _, name in self._names):
            raise CorpusError(
                f"{self.folder / 'new_joint_vecs'}: holds no clip that train.txt, val.txt or "
                "test.txt name"
            )

    def __len__(self) -> int:
        """Return how many clips the split files name."""
        return len(self._names)

    def __iter__(self) -> Iterator[list[ImportedClip | str]]:
        """Read the clips in the order of the split files."""
        for split, name in self._names:
            yield self._read(split, name)

    @cached_property
    def _names(self) -> list[tuple[str, str]]:
        what = f"{self.name} lists the clips of each split, one a line"
        return [
            (split, name)
            for split in SPLITS
            for name in read_lines(self.folder / f"{split}.txt", what)
        ]

    def _features_file(self, name: str) -> Path:
        return self.folder / "new_joint_vecs" / f"{name}.npy"

    def _read(self, split: str, name: str) -> list[ImportedClip | str]:
        if name.startswith(_MIRRORED):
            return ["mirror image"]
        if not self._features_file(name).exists():
            return ["no motion file"]  # the published lists name a few that are not there
        text_file = self.folder / "texts" / f"{name}.txt"
        if not text_file.exists():
            return ["no text file"]
        features = read_array(self._features_file(name), (self.representation.dim,))
        if not np.isfinite(features).all():
            return ["not finite"]
        if not self.min_frames <= len(features) <= _MAX_FRAMES:
            return [self._wrong_length]
        pieces = read_texts(text_file)
        return [self._piece(split, name, features, *piece) for piece in pieces.items()]

    def _piece(
        self,
        split: str,
        name: str,
        features: np.ndarray,
        times: tuple[float, float],
        captions: list[str],
    ) -> ImportedClip | str:
        if times != (0.0, 0.0):
            start, end = times
            features = features[int(start * self.fps) : int(end * self.fps)]
            if not self.min_frames <= len(features) <= _MAX_FRAMES:
                return self._wrong_length
            name = f"{name}_{start:g}-{end:g}"
        return ImportedClip(name, split, tuple(captions), features.astype(np.float32))

    @property
    def _wrong_length(self) -> str:
        return f"not {self.min_frames} to {_MAX_FRAMES} frames"


def read_texts(path: Path) -> dict[tuple[float, float], list[str]]:
    """Read a text file.

    Returns:
        Captions by (start, end), s; (0, 0) is the whole clip.

    Raises:
        CorpusError: If a line is not `caption#tokens#start#end`; names file and line.
    """
    pieces: dict[tuple[float, float], list[str]] = defaultdict(list)
    for number, line in enumerate(read_lines(require(path, ""), "a text file"), start=1):
        fields = line.split("#")
        try:
            caption, _, start, end = fields
            times = tuple(0.0 if math.isnan(t) else t for t in (float(start), float(end)))
        except ValueError as error:
            raise CorpusError(
                f"{path}, line {number}: expected caption#tokens#start#end ({error})"
            ) from error
        if caption.strip():
            pieces[times[0], times[1]].append(caption.strip())
    return pieces
