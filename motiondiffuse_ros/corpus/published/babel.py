"""BABEL (babel.is.tue.mpg.de), which labels motions of AMASS (amass.is.tue.mpg.de).

    BABEL/train.json val.json test.json     sequences by number: feat_p (file in AMASS), dur (s),
                                            seq_ann and frame_ann, null or with `labels`, each with
                                            raw_label, proc_label, act_cat and, in frame_ann,
                                            start_t and end_t, s
    AMASS/.../NAME_poses.npz                SMPL+H: poses [T, 156], trans [T, 3], mocap_framerate

Where there are frame labels each is a clip; otherwise the labels of the sequence are captions of
the whole. Transitions are left out, and so are `extra_*.json`. The labels of the test split are
published as null, so that its sequences have no caption and `val` is what can be evaluated on.

The size of the persons is not known without SMPL's files, so that paths are not scaled.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any, ClassVar
from zipfile import BadZipFile

import numpy as np

from motiondiffuse_ros.corpus.importer import on_floor
from motiondiffuse_ros.corpus.published.dataset import ImportedClip, PublishedDataset
from motiondiffuse_ros.corpus.published.files import check_frames, require
from motiondiffuse_ros.corpus.published.smpl import FROM_Z_UP, motion_from_smpl
from motiondiffuse_ros.corpus.quality import QualityConfig, reason_to_drop
from motiondiffuse_ros.corpus.split import SPLITS
from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.representations import RootRotations

# AMASS's archives unpack to other names now than when BABEL was made
_RENAMED = {
    "BioMotionLab_NTroje": "BMLrub",
    "DFaust_67": "DFaust",
    "MPI_HDM05": "HDM05",
    "MPI_Limits": "PosePrior",
    "MPI_mosh": "MoSh",
    "SSM_synced": "SSM",
    "TCD_handMocap": "TCDHands",
    "Transitions_mocap": "Transitions",
}
_TRANSITION = "transition"


@dataclass(frozen=True)
class Babel(PublishedDataset):
    """BABEL's labels with AMASS's motions.

    Attributes:
        folder: Of the JSON files; train.json is needed.
        amass: AMASS as unpacked.
        quality: Limits beyond which clips are dropped.
    """

    folder: Path
    amass: Path
    quality: QualityConfig = field(default_factory=QualityConfig)
    name: ClassVar[str] = "babel"
    fps: ClassVar[float] = 30.0
    representation: ClassVar[Representation] = RootRotations()

    def validate(self) -> None:
        """Raise CorpusError if the labels cannot be read or no motion is there."""
        if not any(self._motion_file(entry) for _, _, entry in self._sequences):
            raise CorpusError(
                f"{self.amass}: holds none of the files that BABEL names, such as "
                f"{self._sequences[0][2]['feat_p'] if self._sequences else 'CMU/CMU/...'}"
            )

    def __len__(self) -> int:
        """Return the number of sequences."""
        return len(self._sequences)

    def __iter__(self) -> Iterator[list[ImportedClip | str]]:
        """Go through the sequences."""
        for split, number, entry in self._sequences:
            try:
                yield self._read(split, number, entry)
            except (KeyError, TypeError, ValueError) as error:
                raise CorpusError(
                    f"{self.folder / split}.json, sequence {number}: not as BABEL has it "
                    f"({type(error).__name__} {error})"
                ) from error

    @cached_property
    def _sequences(self) -> list[tuple[str, str, dict[str, Any]]]:
        require(self.folder / "train.json", "BABEL has a JSON file for each split")
        return [
            (split, number, entry)
            for split in SPLITS
            if (self.folder / f"{split}.json").exists()
            for number, entry in _read_json(self.folder / f"{split}.json").items()
        ]

    def _motion_file(self, entry: dict[str, Any]) -> Path | None:
        """Return the file of a sequence in any of the layouts that AMASS unpacks to."""
        published = PurePosixPath(entry["feat_p"])
        # feat_p is archive/dataset/person/file; some unpack without the first
        for parts in (published.parts, published.parts[1:]):
            for names in (parts, tuple(_RENAMED.get(p, p) for p in parts)):
                path = self.amass.joinpath(*names)
                if path.is_file():
                    return path
        return None

    def _read(self, split: str, number: str, entry: dict[str, Any]) -> list[ImportedClip | str]:
        pieces = _pieces(entry)
        if not pieces:
            return ["no caption"]
        path = self._motion_file(entry)
        if path is None:
            return ["no motion file"]
        motion = read_amass(path)
        if not (np.isfinite(motion.root).all() and np.isfinite(motion.rotations).all()):
            return ["not finite"]
        motion = on_floor(motion.resample(self.fps))
        return [self._piece(split, number, motion, *piece) for piece in pieces]

    def _piece(
        self,
        split: str,
        number: str,
        motion: Motion,
        times: tuple[float, float] | None,
        captions: tuple[str, ...],
    ) -> ImportedClip | str:
        if captions == (_TRANSITION,):
            return "transition"
        if times is not None:
            start, end = (round(t * self.fps) for t in times)
            if end - start < 2 or start >= motion.frames - 1:
                return f"shorter than {self.quality.min_seconds:g} s"
            motion = motion.slice(start, end)
            number = f"{number}_{times[0]:g}-{times[1]:g}"
        reason = reason_to_drop(motion, captions, self.quality)
        if reason is not None:
            return reason
        return ImportedClip(number, split, captions, self.representation.encode(motion))


def _pieces(entry: dict[str, Any]) -> list[tuple[tuple[float, float] | None, tuple[str, ...]]]:
    """Return (start and end, captions) of each clip of a sequence; None is the whole."""
    if entry.get("frame_ann"):
        by_time: dict[tuple[float, float], list[str]] = {}
        for label in entry["frame_ann"]["labels"]:
            if caption := _caption(label):
                times = (float(label["start_t"]), float(label["end_t"]))
                by_time.setdefault(times, []).append(caption)
        return [(times, tuple(captions)) for times, captions in by_time.items()]
    annotation = entry.get("seq_ann")
    captions = [_caption(label) for label in annotation["labels"]] if annotation else []
    whole = tuple(filter(None, captions))
    return [(None, whole)] if whole else []


def _caption(label: dict[str, Any]) -> str:
    """Return a label as it was typed; empty if it is withheld."""
    if _TRANSITION in (label.get("act_cat") or ()):
        return _TRANSITION
    return str(label.get("raw_label") or label.get("proc_label") or "").strip()


def _read_json(path: Path) -> dict[str, dict[str, Any]]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CorpusError(f"{path}: not JSON ({error})") from error
    if not isinstance(data, dict) or not all(
        isinstance(entry, dict) and isinstance(entry.get("feat_p"), str) for entry in data.values()
    ):
        raise CorpusError(f"{path}: expected sequences by number, each with feat_p")
    return data


def read_amass(path: Path) -> Motion:
    """Read a motion of AMASS at its own rate, its height over the floor not yet set.

    Raises:
        CorpusError: If it is not an archive with poses, trans and the rate.
    """
    try:
        with np.load(path, allow_pickle=False) as data:
            poses, path_of = data["poses"], data["trans"]
            key = "mocap_framerate" if "mocap_framerate" in data else "mocap_frame_rate"
            fps = float(data[key])
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile) as error:
        raise CorpusError(
            f"{path}: expected AMASS's poses, trans and mocap_framerate ({error})"
        ) from error
    width = poses.shape[-1] if poses.ndim == 2 and poses.shape[-1] >= 66 else 156
    poses = check_frames(poses, (width,), f"{path}, poses")
    path_of = check_frames(path_of, (3,), f"{path}, trans")
    if len(poses) != len(path_of) or not fps > 0:
        raise CorpusError(
            f"{path}: {len(poses)} poses, {len(path_of)} positions at {fps} Hz; expected as many "
            "of each and a positive rate"
        )
    return motion_from_smpl(poses, path_of, FROM_Z_UP, fps)
