"""Motions that were published twice."""

from __future__ import annotations

import hashlib
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import replace

from motiondiffuse_ros.corpus.published.dataset import ImportedClip
from motiondiffuse_ros.corpus.split import SPLITS


def without_copies(clips: Sequence[ImportedClip]) -> list[ImportedClip]:
    """Return every motion once.

    CMU has whole subjects under two numbers (64 is 63, 91 is 105, 83 is 122), with captions of
    their own, and the names of two copies put them into different splits. The copy stays whose
    first caption fewer clips share: it says more. It is for training if any copy would be, so that
    what is left for tests is new to everybody.

    Args:
        clips: In any order; that of those that stay is kept.
    """
    shared = Counter(clip.captions[0] for clip in clips)
    copies: dict[bytes, list[int]] = defaultdict(list)
    for i, clip in enumerate(clips):
        copies[hashlib.sha256(clip.features.tobytes()).digest()].append(i)
    kept: dict[int, ImportedClip] = {}
    for own in copies.values():
        most_telling = min(own, key=lambda i: (shared[clips[i].captions[0]], clips[i].name))
        split = min((clips[i].split for i in own), key=SPLITS.index)
        kept[most_telling] = replace(clips[most_telling], split=split)
    return [kept[i] for i in sorted(kept)]
