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
    copies: dict[bytes, list[ImportedClip]] = defaultdict(list)
    for clip in clips:
        copies[hashlib.sha256(clip.features.tobytes()).digest()].append(clip)
    kept: dict[str, str] = {}
    for own in copies.values():
        most_telling = min(own, key=lambda clip: (shared[clip.captions[0]], clip.name))
        kept[most_telling.name] = min((clip.split for clip in own), key=SPLITS.index)
    return [replace(clip, split=kept[clip.name]) for clip in clips if clip.name in kept]
