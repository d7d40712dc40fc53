"""Composition of texts over body parts and time: eq. 10 and eq. 11 of the paper.

A timeline becomes windows. Each window is one text over some frames with a weight for every frame
and feature; over all windows the weights of a frame's feature sum to one. The noise (or any linear
function of it) of the whole motion is then the weighted sum of the windows' noises: masks over
features are the paper's part-aware control, ramps over frames its time-varied control.
"""

from __future__ import annotations

from collections.abc import Mapping
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
        weight: [frames, D] float32 in [0, 1]; its share of every feature of its frames.
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
        part: sum((ramp for t, ramp in on_parts if part in t.parts), np.zeros(frames))
        for part in PARTS
    }
    # where parts' ramps cross their sum may pass one: scale back; the whole body has the rest
    scale = {part: np.maximum(share[part], 1.0) for part in PARTS}
    windows: list[Window] = []
    for text, ramp in on_parts:
        tracks = {part: ramp / scale[part] for part in text.parts}
        windows += _cut(text, ramp, tracks, representation, max_frames, blend_frames)

    rest = {part: 1.0 - share[part] / scale[part] for part in PARTS}
    if any(track.any() for track in rest.values()):
        body = [t for t in texts if not t.parts]
        for text, ramp in _whole_body(body, frames, blend_frames):
            tracks = {part: track * ramp for part, track in rest.items()}
            present = np.max(list(tracks.values()), axis=0)
            windows += _cut(text, present, tracks, representation, max_frames, blend_frames)
    return tuple(windows)


def _whole_body(
    texts: list[TimedText], frames: int, blend_frames: int
) -> list[tuple[TimedText, Array]]:
    """Return texts with ramps [frames] that sum to one; gaps stand still."""
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
    """Return [frames]: one inside, falling linearly over the blend centred on either end.

    An end at the motion's own end does not fall.
    """
    frame = np.arange(frames) + 0.5
    half = max(blend_frames / 2.0, 0.5)
    rise = np.clip((frame - start) / (2 * half) + 0.5, 0.0, 1.0) if start > 0 else 1.0
    fall = np.clip((stop - frame) / (2 * half) + 0.5, 0.0, 1.0) if stop < frames else 1.0
    return np.ones(frames) * rise * fall


def _cut(
    text: TimedText,
    present: Array,
    tracks: Mapping[str, Array],
    representation: Representation,
    max_frames: int,
    blend_frames: int,
) -> list[Window]:
    """Cut a text's weights to where they are not zero, and into windows of at most max_frames.

    Args:
        text: Whose weights.
        present: [frames], zero where the text is not there.
        tracks: Weight [frames] for each part it has a say in.
        representation: Which features a part owns.
        max_frames: Longest window.
        blend_frames: Frames over which windows are blended.
    """
    rows = np.flatnonzero(present)
    if len(rows) == 0:
        return []
    first, stop = int(rows[0]), int(rows[-1]) + 1
    length = stop - first
    if length <= max_frames:
        pieces = [(first, np.ones(length))]
    else:
        # an inner piece is longer by half a blend at either end, and by a frame from rounding
        count = int(np.ceil(length / (max_frames - blend_frames - 1)))
        core = length / count
        bounds = [first + round(i * core) for i in range(count + 1)]
        ramps = [_ramp(a - first, b - first, length, blend_frames) for a, b in pairwise(bounds)]
        total = np.sum(ramps, axis=0)
        kept = [(np.flatnonzero(ramp), ramp / total) for ramp in ramps]
        pieces = [(first + int(at[0]), ramp[at[0] : at[-1] + 1]) for at, ramp in kept]
    windows = []
    for start, ramp in pieces:
        weight = np.zeros((len(ramp), representation.dim), dtype=np.float32)
        for part, track in tracks.items():
            share = track[start : start + len(ramp)] * ramp
            weight[:, representation.part_indices(part)] = share[:, None]
        windows.append(Window(text.text, start, weight, text.parts))
    return windows
