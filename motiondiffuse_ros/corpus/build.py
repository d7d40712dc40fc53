"""`corpus build`: folders of BVH files and caption files become a corpus."""

from __future__ import annotations

import multiprocessing
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from motiondiffuse_ros.corpus.captions import captions_of, read_captions
from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.corpus.quality import QualityConfig, reason_to_drop
from motiondiffuse_ros.corpus.skeleton_map import SkeletonMap
from motiondiffuse_ros.corpus.split import split_of
from motiondiffuse_ros.corpus.statistics import compute_statistics
from motiondiffuse_ros.corpus.store import Corpus, pack_clips
from motiondiffuse_ros.errors import CorpusError, MotionFileError
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.rotations import Array


@dataclass(frozen=True)
class Source:
    """A folder of BVH files and how to read them.

    Attributes:
        dataset: Name the clips are filed under.
        folder: Searched through for `*.bvh`.
        skeleton_map: None chooses among the shipped maps by joint names.
    """

    dataset: str
    folder: Path
    skeleton_map: SkeletonMap | None = None


@dataclass(frozen=True)
class BuildConfig:
    """What `build_corpus` makes.

    Attributes:
        sources: Folders to import.
        captions: Caption files.
        fps: Frame rate of the corpus, Hz.
        quality: Limits beyond which clips are dropped.
        workers: Processes.
    """

    sources: tuple[Source, ...]
    captions: tuple[Path, ...]
    fps: float = 20.0
    quality: QualityConfig = field(default_factory=QualityConfig)
    workers: int = 2

    def validate(self) -> None:
        """Raise CorpusError if nothing can be built from this."""
        if not self.sources:
            raise CorpusError("no source folders: give --cmu, --bandai-namco or --bvh")
        for source in self.sources:
            if not source.folder.is_dir():
                raise CorpusError(f"{source.dataset}: {source.folder} is not a folder")
            if next(source.folder.rglob("*.bvh"), None) is None:
                raise CorpusError(f"{source.dataset}: no .bvh file under {source.folder}")
        if not 1.0 <= self.fps <= 240.0:
            raise CorpusError(f"fps must be from 1 to 240 Hz, got {self.fps}")
        self.quality.validate()


@dataclass(frozen=True)
class _Job:
    path: Path
    source: Source
    captions: tuple[str, ...]


def build_corpus(
    config: BuildConfig, *, on_progress: Callable[[int, int], None] | None = None
) -> Corpus:
    """Import, filter, encode and split every clip.

    Args:
        config: What to build.
        on_progress: Called with (clips done, clips in all).

    Raises:
        CorpusError: If the configuration is invalid or no clip is left for training.
    """
    config.validate()
    captions = read_captions(config.captions)
    jobs = [
        _Job(path, source, captions_of(path.stem, captions))
        for source in config.sources
        for path in sorted(source.folder.rglob("*.bvh"))
    ]
    entries, dropped = [], Counter[str]()
    for done, (job, result) in enumerate(_import_all(jobs, config), start=1):
        if isinstance(result, str):
            dropped[result] += 1
        else:
            dataset, name = job.source.dataset, job.path.stem
            entries.append((name, dataset, split_of(dataset, name), job.captions, result))
        if on_progress is not None:
            on_progress(done, len(jobs))
    representation = PoseState()
    train = [e[4] for e in entries if e[2] == "train"]
    if not train:
        raise CorpusError(f"no clip is left for training; dropped: {dict(dropped)}")
    clips, features = pack_clips(entries)
    statistics = compute_statistics(train, representation)
    return Corpus(clips, features, statistics, representation, config.fps, dict(dropped))


def _import_all(jobs: Sequence[_Job], config: BuildConfig) -> Iterator[tuple[_Job, Array | str]]:
    work = partial(_import, fps=config.fps, quality=config.quality)
    if config.workers <= 1:
        yield from zip(jobs, map(work, jobs), strict=True)
        return
    # spawn: forking a process that runs torch or ROS threads can hang
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(config.workers, mp_context=context) as pool:
        yield from zip(jobs, pool.map(work, jobs, chunksize=16), strict=True)


def _import(job: _Job, fps: float, quality: QualityConfig) -> Array | str:
    """Return the features of a clip, or why it is dropped."""
    if not job.captions:
        return "no caption"  # spares reading the file
    try:
        motion = load_motion(job.path, job.source.skeleton_map)
    except MotionFileError:
        return "unreadable"
    reason = reason_to_drop(motion, job.captions, quality)
    if reason is not None:
        return reason
    return PoseState().encode(motion.resample(fps))
