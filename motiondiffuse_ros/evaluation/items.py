"""What is evaluated: a text and the real window it belongs to, for every clip of a split."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from motiondiffuse_ros.corpus.store import Clip, Corpus
from motiondiffuse_ros.motion.rotations import Array

MIN_FRAMES = 40
"""Shorter windows are left out, as in HumanML3D (2 s at 20 fps)."""


@dataclass(frozen=True, eq=False)
class Item:
    """One text with its real motion.

    Attributes:
        clip: Where it is from.
        text: One of its captions.
        features: The window [T, D], not normalised.
    """

    clip: Clip
    text: str
    features: Array = field(repr=False)


def draw_items(
    corpus: Corpus, clips: Sequence[Clip], max_frames: int, rng: np.random.Generator
) -> list[Item]:
    """Draw a caption and a window of at most `max_frames` for each clip that is long enough."""
    items = []
    for clip in clips:
        if clip.frames >= MIN_FRAMES:
            text = clip.captions[rng.integers(len(clip.captions))]
            items.append(Item(clip, text, draw_window(corpus, clip, max_frames, rng)))
    return items


def draw_window(corpus: Corpus, clip: Clip, frames: int, rng: np.random.Generator) -> Array:
    """Return a window of a clip [at most frames, D] from a random place."""
    start = int(rng.integers(max(clip.frames - frames, 0) + 1))
    return corpus.of(clip)[start : start + frames]
