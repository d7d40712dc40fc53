"""`corpus build`: BVH files with caption files, or published data sets, become a corpus."""

from __future__ import annotations

import multiprocessing
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from pathlib import Path

from motiondiffuse_ros.corpus.captions import captions_of, read_captions
from motiondiffuse_ros.corpus.copies import without_copies
from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.corpus.published.dataset import ImportedClip, PublishedDataset
from motiondiffuse_ros.corpus.quality import QualityConfig, reason_to_drop
from motiondiffuse_ros.corpus.skeleton_map import SkeletonMap
from motiondiffuse_ros.corpus.split import split_of
from motiondiffuse_ros.corpus.statistics import compute_statistics
from motiondiffuse_ros.corpus.store import Corpus, pack_clips
from motiondiffuse_ros.errors import CorpusError, MotionFileError
from motiondiffuse_ros.motion.features import PoseState, Representation


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
        fps: Frame rate of what is read from `sources`, Hz.
        quality: Limits beyond which clips are dropped.
        workers: Processes.
        published: Data sets in their published layouts, which keep their own representation,
            rate and split.
    """

    sources: tuple[Source, ...]
    captions: tuple[Path, ...]
    fps: float = 20.0
    quality: QualityConfig = field(default_factory=QualityConfig)
    workers: int = 2
    published: tuple[PublishedDataset, ...] = ()

    def validate(self) -> None:
        """Raise CorpusError if nothing can be built from this."""
        if not self.sources and not self.published:
            raise CorpusError(
                "no source folders: give --cmu, --bandai-namco or --bvh, or one of --humanml3d, "
                "--kit-ml, --humanact12, --uestc, --babel"
            )
        for source in self.sources:
            if not source.folder.is_dir():
                raise CorpusError(f"{source.dataset}: {source.folder} is not a folder")
            if next(source.folder.rglob("*.bvh"), None) is None:
                raise CorpusError(f"{source.dataset}: no .bvh file under {source.folder}")
        if not 1.0 <= self.fps <= 240.0:
            raise CorpusError(f"fps must be from 1 to 240 Hz, got {self.fps}")
        self.quality.validate()
        self._one_kind()
        for dataset in self.published:
            dataset.validate()

    def features(self) -> tuple[Representation, float]:
        """Return the representation and rate of the corpus."""
        if self.published:
            return self.published[0].representation, self.published[0].fps
        return PoseState(), self.fps

    def _one_kind(self) -> None:
        kinds = {s.dataset: (PoseState.name, self.fps) for s in self.sources}
        kinds |= {d.name: (d.representation.name, d.fps) for d in self.published}
        if len(set(kinds.values())) > 1:
            listed = ", ".join(f"{n}: {name} at {fps:g} Hz" for n, (name, fps) in kinds.items())
            raise CorpusError(
                f"a corpus has one representation and rate, these differ ({listed}); build one "
                "corpus for each"
            )


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
    total = len(jobs) + sum(map(len, config.published))
    found, dropped = defaultdict[str, list[ImportedClip]](list), Counter[str]()
    results = chain(_import_all(jobs, config), *map(_read_published, config.published))
    for done, (dataset, clips) in enumerate(results, start=1):
        for clip in clips:
            if isinstance(clip, str):
                dropped[clip] += 1
            else:
                found[dataset].append(clip)
        if on_progress is not None:
            on_progress(done, total)
    for source in config.sources:  # published data sets keep their own splits
        once = without_copies(found[source.dataset])
        if len(once) < len(found[source.dataset]):
            dropped["copy of another clip"] += len(found[source.dataset]) - len(once)
        found[source.dataset] = once
    representation, fps = config.features()
    train = [clip.features for own in found.values() for clip in own if clip.split == "train"]
    if not train:
        raise CorpusError(f"no clip is left for training; dropped: {dict(dropped)}")
    clips, features = pack_clips(
        [
            (clip.name, dataset, clip.split, clip.captions, clip.features)
            for dataset, own in found.items()
            for clip in own
        ]
    )
    statistics = compute_statistics(train, representation)
    return Corpus(clips, features, statistics, representation, fps, dict(dropped))


_Result = tuple[str, Sequence[ImportedClip | str]]
"""A data set's name, and the clips or reasons for dropping that one of its items gave."""


def _read_published(dataset: PublishedDataset) -> Iterator[_Result]:
    for clips in dataset:
        yield dataset.name, clips


def _import_all(jobs: Sequence[_Job], config: BuildConfig) -> Iterator[_Result]:
    work = partial(_import, fps=config.fps, quality=config.quality)
    names = [job.source.dataset for job in jobs]
    if config.workers <= 1 or not jobs:
        yield from zip(names, map(work, jobs), strict=True)
        return
    # spawn: forking a process that runs torch or ROS threads can hang
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(config.workers, mp_context=context) as pool:
        yield from zip(names, pool.map(work, jobs, chunksize=16), strict=True)


def _import(job: _Job, fps: float, quality: QualityConfig) -> tuple[ImportedClip | str]:
    """Return the clip of a file, or why it is dropped."""
    if not job.captions:
        return ("no caption",)  # spares reading the file
    try:
        motion = load_motion(job.path, job.source.skeleton_map)
    except MotionFileError:
        return ("unreadable",)
    reason = reason_to_drop(motion, job.captions, quality)
    if reason is not None:
        return (reason,)
    dataset, name = job.source.dataset, job.path.stem
    features = PoseState().encode(motion.resample(fps))
    return (ImportedClip(name, split_of(dataset, name), job.captions, features),)
