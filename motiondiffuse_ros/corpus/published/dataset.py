"""What every importer of a published data set gives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.rotations import Array


@dataclass(frozen=True, eq=False)
class ImportedClip:
    """One clip.

    Attributes:
        name: Its published name; a piece of a clip has its times appended.
        split: One of `SPLITS`.
        captions: At least one.
        features: [T, D] in the data set's representation, at its rate.
    """

    name: str
    split: str
    captions: tuple[str, ...]
    features: Array = field(repr=False)


class PublishedDataset(ABC):
    """A data set on disk.

    Iterating gives, for each published item, its clips, and for what is left out the reason.

    Attributes:
        name: That the clips are filed under.
        representation: What the features mean: the paper's for this data set.
        fps: Rate of the features, Hz.
    """

    name: ClassVar[str]
    representation: ClassVar[Representation]
    fps: ClassVar[float]

    @abstractmethod
    def validate(self) -> None:
        """Raise CorpusError if the folder is not laid out as published."""

    @abstractmethod
    def __len__(self) -> int:
        """Return the number of items."""

    @abstractmethod
    def __iter__(self) -> Iterator[Sequence[ImportedClip | str]]:
        """Go through the items."""
