"""`motiondiffuse corpus`: build a corpus from motion capture; say where the originals are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.corpus.build import BuildConfig, Source, build_corpus
from motiondiffuse_ros.corpus.captions import shipped_caption_files
from motiondiffuse_ros.corpus.originals import fetch
from motiondiffuse_ros.corpus.published import (
    Babel,
    HumanAct12,
    HumanML3DFolder,
    KitMLFolder,
    PublishedDataset,
    Uestc,
)
from motiondiffuse_ros.corpus.quality import QualityConfig
from motiondiffuse_ros.corpus.skeleton_map import SkeletonMap
from motiondiffuse_ros.corpus.split import SPLITS
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.errors import InputError


@dataclass(frozen=True)
class Build:
    """Import motion with captions into a corpus for training: BVH files, or a published data set.

    A published data set keeps its own representation, rate and split; only data sets that agree
    in representation and rate can be built into one corpus.
    """

    cmu: Path | None = None
    """Folder of the CMU database as BVH (Daz-friendly cgspeed conversion)."""
    bandai_namco: Path | None = None
    """Folder of the Bandai-Namco Research Motiondataset."""
    bvh: tuple[Path, ...] = ()
    """Further folders of BVH files."""
    skeleton_map: Path | None = None
    """YAML skeleton map for the folders of --bvh; a shipped one that fits if not given."""
    humanml3d: Path | None = None
    """Folder of HumanML3D (train.txt, new_joint_vecs, texts)."""
    kit_ml: Path | None = None
    """Folder of KIT-ML in the same layout."""
    humanact12: Path | None = None
    """Folder of HumanAct12's .npy files."""
    uestc: Path | None = None
    """Folder of UESTC's poses as published with ACTOR (vibe_cache_refined.pkl, info)."""
    babel: Path | None = None
    """Folder of BABEL's JSON files; needs --amass."""
    amass: Path | None = None
    """Folder of AMASS, for --babel."""
    captions: tuple[Path, ...] = ()
    """Caption files (JSON lines) for BVH files; the shipped ones if not given."""
    out: Path = Path("corpus")
    """Folder for the corpus."""
    fps: float = 20.0
    """Frame rate of what is read from BVH files [Hz]."""
    min_seconds: float = QualityConfig.min_seconds
    """Shorter clips are dropped [s]."""
    max_joint_speed: float = QualityConfig.max_joint_speed
    """Clips with a faster joint are dropped [m/s]."""
    max_root_speed: float = QualityConfig.max_root_speed
    """Clips with a faster root are dropped [m/s]."""
    workers: int = 2
    """Processes."""


@dataclass(frozen=True)
class Fetch:
    """Get the public original of a data set where a single file holds it, or say how to."""

    name: Annotated[str, tyro.conf.Positional]
    """cmu or bandai-namco."""
    out: Path = Path("data")
    """Folder for what is downloaded."""


def main(arguments: Sequence[str]) -> int:
    """Run `corpus build` or `corpus fetch`; returns the exit code."""
    usage = "motiondiffuse corpus build|fetch ...; add --help for more"
    if arguments and arguments[0] == "build":
        return _build(parse(Build, arguments[1:], "corpus build"))
    if arguments and arguments[0] == "fetch":
        options = parse(Fetch, arguments[1:], "corpus fetch")
        print(fetch(options.name, options.out))
        return 0
    if arguments and arguments[0] in ("-h", "--help"):
        print(f"usage: {usage}")
        return 0
    raise InputError(f"corpus needs build or fetch: {usage}")


def _build(options: Build) -> int:
    named = (("cmu", options.cmu), ("bandai_namco", options.bandai_namco))
    sources = [Source(name, folder) for name, folder in named if folder is not None]
    own_map = None if options.skeleton_map is None else SkeletonMap.from_yaml(options.skeleton_map)
    sources += [Source(folder.resolve().name, folder, own_map) for folder in options.bvh]
    quality = QualityConfig(
        min_seconds=options.min_seconds,
        max_joint_speed=options.max_joint_speed,
        max_root_speed=options.max_root_speed,
    )
    config = BuildConfig(
        tuple(sources),
        options.captions or shipped_caption_files(),
        options.fps,
        quality,
        options.workers,
        _published(options, quality),
    )
    config.validate()
    console = Console()
    columns = (TextColumn("importing"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as bar:
        task = bar.add_task("importing", total=None)
        corpus = build_corpus(
            config, on_progress=lambda done, total: bar.update(task, completed=done, total=total)
        )
    corpus.save(options.out)
    console.print(_summary(corpus))
    for reason, count in sorted(corpus.dropped.items(), key=lambda item: -item[1]):
        console.print(f"dropped {count}: {reason}")
    console.print(f"written to {options.out}")
    return 0


def _published(options: Build, quality: QualityConfig) -> tuple[PublishedDataset, ...]:
    chosen: list[PublishedDataset] = []
    if options.humanml3d is not None:
        chosen.append(HumanML3DFolder(options.humanml3d))
    if options.kit_ml is not None:
        chosen.append(KitMLFolder(options.kit_ml))
    if options.humanact12 is not None:
        chosen.append(HumanAct12(options.humanact12, quality))
    if options.uestc is not None:
        chosen.append(Uestc(options.uestc, quality))
    if (options.babel is None) != (options.amass is None):
        raise InputError("--babel and --amass go together: BABEL labels the motions of AMASS")
    if options.babel is not None and options.amass is not None:
        chosen.append(Babel(options.babel, options.amass, quality))
    return tuple(chosen)


def _summary(corpus: Corpus) -> Table:
    table = Table("data set", *SPLITS, "clips", "hours", "captions", title="corpus")
    for name in sorted({c.dataset for c in corpus.clips}):
        clips = [c for c in corpus.clips if c.dataset == name]
        splits = Counter(c.split for c in clips)
        hours = sum(c.frames for c in clips) / corpus.fps / 3600.0
        captions = {caption for c in clips for caption in c.captions}
        table.add_row(
            name,
            *(str(splits[s]) for s in SPLITS),
            str(len(clips)),
            f"{hours:.2f}",
            str(len(captions)),
        )
    return table
