"""Windows: fixed-rate pieces of clips with a caption, drawn for training."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from motiondiffuse_ros.corpus.captions import mirror_caption
from motiondiffuse_ros.corpus.sideways import name_side
from motiondiffuse_ros.corpus.store import Clip, Corpus

_BUCKET_BATCHES = 8
_LENGTH_STEP = 28


@dataclass(frozen=True)
class WindowBatch:
    """A batch of windows.

    Attributes:
        features: Normalised, padded with zeros [B, T, D].
        lengths: Frames that count [B].
        texts: B sentences.
    """

    features: torch.Tensor
    lengths: torch.Tensor
    texts: list[str]


@dataclass(frozen=True)
class _Window:
    clip: Clip
    start: int
    frames: int
    mirrored: bool
    text: str


class WindowSampler:
    """Draws windows without end, batches of like length together."""

    def __init__(
        self, corpus: Corpus, clips: Sequence[Clip], *, max_frames: int, mirror: float, seed: int
    ) -> None:
        self._corpus, self._clips, self._max_frames = corpus, clips, max_frames
        self._mirror = mirror
        self._rng = np.random.default_rng(seed)
        self._probability = clip_probabilities(clips, 4 * max_frames)
        self._mirror_index, self._mirror_sign = corpus.representation.mirror()
        self._step = _LENGTH_STEP if max_frames % _LENGTH_STEP == 0 else max_frames

    def batches(self, batch_size: int) -> Iterator[WindowBatch]:
        """Yield batches for ever."""
        while True:
            windows = [self._draw() for _ in range(batch_size * _BUCKET_BATCHES)]
            windows.sort(key=lambda w: w.frames)
            for b in self._rng.permutation(_BUCKET_BATCHES):
                yield self._collate(windows[b * batch_size : (b + 1) * batch_size])

    def _draw(self) -> _Window:
        clip = self._clips[self._rng.choice(len(self._clips), p=self._probability)]
        frames = min(clip.frames, self._max_frames)
        start = int(self._rng.integers(clip.frames - frames + 1))
        mirrored = bool(self._rng.random() < self._mirror)
        corpus = self._corpus
        text = name_side(
            clip.captions[self._rng.integers(len(clip.captions))],
            corpus.of(clip)[start : start + frames],
            corpus.representation,
            corpus.fps,
        )
        return _Window(clip, start, frames, mirrored, mirror_caption(text) if mirrored else text)

    def _collate(self, windows: Sequence[_Window]) -> WindowBatch:
        # few distinct lengths, so that compiled kernels are reused
        longest = -(-max(w.frames for w in windows) // self._step) * self._step
        features = np.zeros(
            (len(windows), longest, self._corpus.representation.dim), dtype=np.float32
        )
        for row, w in zip(features, windows, strict=True):
            x = self._corpus.of(w.clip)[w.start : w.start + w.frames]
            if w.mirrored:
                x = x[:, self._mirror_index] * self._mirror_sign
            row[: w.frames] = self._corpus.statistics.normalise(x)
        lengths = torch.tensor([w.frames for w in windows])
        return WindowBatch(torch.from_numpy(features), lengths, [w.text for w in windows])


def clip_probabilities(clips: Sequence[Clip], max_frames: int) -> np.ndarray:
    """Return how often each clip is drawn [len(clips)].

    Data sets have equal shares. Within one a clip counts by the square root of its length (a
    minute-long clip holds more, but its captions say less), and n clips that share their captions
    count as the square root of n: four hundred takes of one gesture would crowd out the bow.
    """
    takes = Counter((clip.dataset, clip.captions) for clip in clips)
    weight = np.array(
        [
            np.sqrt(min(clip.frames, max_frames) / takes[clip.dataset, clip.captions])
            for clip in clips
        ]
    )
    for dataset in {clip.dataset for clip in clips}:
        own = np.array([clip.dataset == dataset for clip in clips])
        weight[own] /= weight[own].sum()
    return weight / weight.sum()
