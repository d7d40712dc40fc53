"""Clips of a corpus's split that are on level ground, leaning on nothing and nobody."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np

from motiondiffuse_ros.corpus.store import Clip, Corpus
from motiondiffuse_ros.motion import Motion

_CAPTIONS = Path(__file__).parents[1] / "motiondiffuse_ros" / "corpus" / "captions"

# Clips whose description names one of these are not on level ground or lean on something.
_NOT_LEVEL = re.compile(
    r"stair|climb|ladder|stool|chair|sit|seat|bench|sofa|couch|terrain|uneven|platform|beam|curb|"
    r"playground|swing|hang|pull up|monkey|bed\b|lie|lying|swim|motorcycle|two |partner|box|"
    r"hop over|jump off|step up|step over|stepping over|slope|ramp|hill|obstacle|cartwheel|"
    r"ledge|(and|to) (up|down)\b|skateboard|superhero|"
    r"acrobat|flip|trampoline|pole|handstand|crawl|roll|ball|mantis|car\b|door|wall|lean",
    re.IGNORECASE,
)
_MIN_SECONDS = 1.0


def level_clips(
    corpus: Corpus, split: str, count: int, max_seconds: float, rng: np.random.Generator
) -> list[tuple[Clip, Motion]]:
    """Return clips at random, as many of each data set, with at most their first seconds."""
    cmu = _level_cmu()
    chosen: list[tuple[Clip, Motion]] = []
    clips = [clip for clip in corpus.split(split) if clip.frames >= _MIN_SECONDS * corpus.fps]
    sets = {clip.dataset for clip in clips}
    for name in sorted(sets):
        level = [c for c in clips if c.dataset == name and (name != "cmu" or c.name in cmu)]
        for index in rng.permutation(len(level))[: count // len(sets)]:
            motion = corpus.representation.decode(corpus.of(level[index]), corpus.fps)
            chosen.append((level[index], motion.slice(0, round(max_seconds * corpus.fps))))
    return chosen


def _level_cmu() -> set[str]:
    level = set()
    for line in (_CAPTIONS / "cmu_captions.jsonl").read_text(encoding="utf-8").splitlines():
        entry = json.loads(line)
        words = f"{entry['index']} {entry['subject']} {' '.join(entry['captions'])}"
        glitch = entry["max_joint_speed"] > 15.0 or entry["max_root_speed"] > 8.0
        if entry["captions"] and not glitch and not _NOT_LEVEL.search(words):
            level.add(entry["clip"])
    return level
