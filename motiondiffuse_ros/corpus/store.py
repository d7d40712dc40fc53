"""The corpus folder: what `corpus build` writes and training and evaluation read.

corpus.json              format, representation, fps, clips (name, dataset, split, frames,
                         captions), what was dropped and why
features.safetensors     `features` [sum of frames, D] float32, clips one after the other
statistics.safetensors   mean and std over the training split
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from motiondiffuse_ros.corpus.split import SPLITS
from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion.features import REPRESENTATIONS, Representation
from motiondiffuse_ros.motion.rotations import Array

FORMAT = 1


@dataclass(frozen=True)
class Clip:
    """One clip of a corpus.

    Attributes:
        name: File name without suffix.
        dataset: Name of the skeleton map it was read with.
        split: One of `SPLITS`.
        captions: At least one sentence.
        start: First row in the feature matrix.
        frames: Number of rows.
    """

    name: str
    dataset: str
    split: str
    captions: tuple[str, ...]
    start: int
    frames: int


@dataclass(frozen=True, eq=False)
class Corpus:
    """A corpus in memory.

    Attributes:
        clips: All clips.
        features: [sum of frames, D] float32, not normalised.
        statistics: Of the training split.
        representation: What the features mean.
        fps: Frames per second of the features.
        dropped: Number of clips dropped, by reason.
    """

    clips: tuple[Clip, ...]
    features: Array = field(repr=False)
    statistics: Statistics
    representation: Representation
    fps: float
    dropped: dict[str, int]

    def split(self, name: str) -> tuple[Clip, ...]:
        """Return the clips of a split, or of all splits for "all".

        Raises:
            CorpusError: If there is no such split, or it has no clip.
        """
        if name not in (*SPLITS, "all"):
            raise CorpusError(f"unknown split '{name}'; the splits are {', '.join(SPLITS)}, all")
        clips = tuple(c for c in self.clips if name in ("all", c.split))
        if not clips:
            raise CorpusError(f"the corpus has no clip in the split '{name}'")
        return clips

    def of(self, clip: Clip) -> Array:
        """Return the features [frames, D] of a clip."""
        return self.features[clip.start : clip.start + clip.frames]

    def save(self, folder: Path) -> None:
        """Write the corpus folder."""
        folder.mkdir(parents=True, exist_ok=True)
        save_file({"features": self.features}, folder / "features.safetensors")
        self.statistics.save(folder / "statistics.safetensors")
        manifest = {
            "format": FORMAT,
            "representation": self.representation.name,
            "fps": self.fps,
            "dropped": self.dropped,
            "clips": [asdict(c) for c in self.clips],
        }
        # the manifest comes last: a folder without it is not a corpus
        (folder / "corpus.json").write_text(json.dumps(manifest, indent=1), encoding="utf-8")

    @classmethod
    def load(cls, folder: Path) -> Corpus:
        """Read a corpus folder.

        Raises:
            CorpusError: If it is missing, incomplete or of another format.
        """
        path = Path(folder) / "corpus.json"
        try:
            manifest = json.loads(path.read_text(encoding="utf-8"))
            if manifest["format"] != FORMAT:
                raise CorpusError(
                    f"{path}: format {manifest['format']}, this version reads {FORMAT}"
                )
            clips = tuple(
                Clip(**{**c, "captions": tuple(c["captions"])}) for c in manifest["clips"]
            )
            features = load_file(Path(folder) / "features.safetensors")["features"]
            representation = REPRESENTATIONS[manifest["representation"]]()
            fps, dropped = float(manifest["fps"]), dict(manifest["dropped"])
        except (OSError, ValueError, KeyError, TypeError, SafetensorError) as error:
            raise CorpusError(
                f"{folder}: not a corpus folder ({error}); make one with "
                "`motiondiffuse corpus build`"
            ) from error
        if len(features) != sum(c.frames for c in clips):
            raise CorpusError(
                f"{folder}: features.safetensors does not fit corpus.json; build again"
            )
        statistics = Statistics.load(Path(folder) / "statistics.safetensors")
        return cls(clips, features, statistics, representation, fps, dropped)


def pack_clips(
    entries: Sequence[tuple[str, str, str, tuple[str, ...], Array]],
) -> tuple[tuple[Clip, ...], Array]:
    """Lay clips (name, dataset, split, captions, features) one after the other."""
    clips, start = [], 0
    for name, dataset, split, captions, features in entries:
        clips.append(Clip(name, dataset, split, captions, start, len(features)))
        start += len(features)
    return tuple(clips), np.concatenate([e[4] for e in entries]).astype(np.float32)
