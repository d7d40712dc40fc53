"""Composition of texts over body parts and time: eq. 10 and eq. 11 of the paper.

A timeline becomes windows. Each window is one text over some frames with a weight for every frame
and feature; over all windows the weights of a frame's feature sum to one. The noise (or any linear
function of it) of the whole motion is then the weighted sum of the windows' noises: masks over
features are the paper's part-aware control, ramps over frames its time-varied control.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.parts import PARTS
from motiondiffuse_ros.motion.rotations import Array

STILL_TEXT = "a person stands still"
"""What the body does where nothing is asked of it."""


@dataclass(frozen=True)
class TimedText:
    """A text on some parts from one frame up to, not including, another; no parts = whole body."""

    text: str
    start: int
    stop: int
    parts: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Window:
    """One text denoised over consecutive frames.

    Attributes:
        text: The condition.
        start: First frame.
        weight: [frames, D] in [0, 1]; its share of every feature of its frames.
        parts: Parts that the text was given to; empty is the whole body.
    """

    text: str
    start: int
    weight: Array = field(repr=False)
    parts: tuple[str, ...] = ()

    @property
    def stop(self) -> int:
        """Frame after the last."""
        return self.start + len(self.weight)


def compose(
    texts: tuple[TimedText, ...],
    frames: int,
    representation: Representation,
    *,
    max_frames: int,
    blend_frames: int,
) -> tuple[Window, ...]:
    """Lay out the windows of a timeline.

    Args:
        texts: Whole-body texts and part texts; neighbours on a track are blended.
        frames: Length of the motion.
        representation: Which features a part owns.
        max_frames: Longest window that the denoiser takes.
        blend_frames: Frames over which neighbours are blended.

    Returns:
        Windows whose weights sum to one at every frame and feature.
    """
    on_parts = [(t, _ramp(t.start, t.stop, frames, blend_frames)) for t in texts if t.parts]
    share = {
        part: sum((ramp for t, ramp in on_parts if part in t.parts), np.zeros((frames, 1)))
        for part in PARTS
    }
    # where parts' ramps cross their sum may pass one: scale back; the whole body has the rest
    scale = {part: np.maximum(share[part], 1.0) for part in PARTS}
    windows: list[Window] = []
    for text, ramp in on_parts:
        weight = np.zeros((frames, representation.dim))
        for part in text.parts:
            weight[:, representation.part_indices(part)] = ramp / scale[part]
        windows += _cut(text, weight, max_frames, blend_frames)

    base = np.zeros((frames, representation.dim))
    for part in PARTS:
        base[:, representation.part_indices(part)] = 1.0 - share[part] / scale[part]
    if base.any():
        body = [t for t in texts if not t.parts]
        for text, ramp in _whole_body(body, frames, blend_frames):
            windows += _cut(text, base * ramp, max_frames, blend_frames)
    return tuple(windows)


def _whole_body(
    texts: list[TimedText], frames: int, blend_frames: int
) -> list[tuple[TimedText, Array]]:
    """Return texts with ramps [frames, 1] that sum to one; gaps stand still."""
    filled: list[TimedText] = []
    place = 0
    for text in sorted(texts, key=lambda t: t.start):
        if text.start > place:
            filled.append(TimedText(STILL_TEXT, place, text.start))
        filled.append(text)
        place = max(place, text.stop)
    if place < frames:
        filled.append(TimedText(STILL_TEXT, place, frames))
    ramps = [_ramp(t.start, t.stop, frames, blend_frames) for t in filled]
    total = np.maximum(sum(ramps), 1e-9)
    return [(t, ramp / total) for t, ramp in zip(filled, ramps, strict=True)]


def _ramp(start: int, stop: int, frames: int, blend_frames: int) -> Array:
    """Return [frames, 1]: one inside, falling linearly over the blend centred on either end.

    An end at the motion's own end does not fall.
    """
    frame = np.arange(frames) + 0.5
    half = max(blend_frames / 2.0, 0.5)
    rise = np.clip((frame - start) / (2 * half) + 0.5, 0.0, 1.0) if start > 0 else 1.0
    fall = np.clip((stop - frame) / (2 * half) + 0.5, 0.0, 1.0) if stop < frames else 1.0
    return (np.ones(frames) * rise * fall)[:, None]


def _cut(text: TimedText, weight: Array, max_frames: int, blend_frames: int) -> list[Window]:
    """Cut one text's weights to where they are not zero, and into windows of at most max_frames."""
    rows = np.flatnonzero(weight.any(axis=1))
    if len(rows) == 0:
        return []
    first, stop = int(rows[0]), int(rows[-1]) + 1
    length = stop - first
    if length <= max_frames:
        return [Window(text.text, first, weight[first:stop], text.parts)]
    # an inner piece is longer by half a blend at either end, and by a frame from rounding
    count = int(np.ceil(length / (max_frames - blend_frames - 1)))
    core = length / count
    bounds = [first + round(i * core) for i in range(count + 1)]
    ramps = [_ramp(a - first, b - first, length, blend_frames)[:, 0] for a, b in pairwise(bounds)]
    total = np.sum(ramps, axis=0)
    windows = []
    for ramp in ramps:
        kept = np.flatnonzero(ramp)
        a, b = int(kept[0]), int(kept[-1]) + 1
        piece = weight[first + a : first + b] * (ramp / total)[a:b, None]
        windows.append(Window(text.text, first + a, piece, text.parts))
    return windows
