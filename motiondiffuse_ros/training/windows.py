"""Windows: fixed-rate pieces of clips with a caption, drawn for training."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch

from motiondiffuse_ros.corpus.captions import mirror_caption
from motiondiffuse_ros.corpus.sideways import name_side
from motiondiffuse_ros.corpus.statements import state, state_in_reverse
from motiondiffuse_ros.corpus.store import Clip, Corpus
from motiondiffuse_ros.corpus.wordings import deeds_of
from motiondiffuse_ros.training.texts import named_deeds, texts_of

_BUCKET_BATCHES = 8
_LENGTH_STEP = 28
_STATED_SECONDS = (3.0, 5.0, 8.0)
_CROP_SECONDS = 4.0
_OTHER_WORDS = 3


@dataclass(frozen=True)
class WindowBatch:
    """A batch of windows.

    Attributes:
        features: Normalised, padded with zeros [B, T, D].
        lengths: Frames that count [B].
        texts: B sentences.
        synonyms: For each window every sentence that it might have come with.
    """

    features: torch.Tensor
    lengths: torch.Tensor
    texts: list[str]
    synonyms: list[frozenset[str]]


@dataclass(frozen=True)
class _Window:
    clip: Clip
    start: int
    frames: int
    texts: tuple[str, ...]
    mirrored: bool = False
    reversed: bool = False


class WindowSampler:
    """Draws windows without end, batches of like length together.

    Most come with a caption of their clip, a share of `statements` with what their kinematics
    state for certain; of those each kind of statement is as frequent as any other, and walking
    backward is half of the time walking forward played in reverse. A share of `deeds` comes with a
    caption, too, but each deed that `corpus.wordings` knows is as frequent as any other. Beside its
    captions a clip comes with a few other words, other ones each time: words that always come with
    the same clip would stand for that clip. Of clips that do not fit into a window a share of
    `crop` is shown in shorter pieces: their captions speak of the whole clip, so that no piece fits
    better than another, and people ask for any length.
    """

    def __init__(
        self,
        corpus: Corpus,
        clips: Sequence[Clip],
        *,
        max_frames: int,
        mirror: float,
        statements: float = 0.0,
        deeds: float = 0.0,
        crop: float = 0.0,
        texts: Callable[[Clip], Sequence[str]] = texts_of,
        other_words: Callable[[Clip], Sequence[str]] = lambda clip: (),
        seed: int,
    ) -> None:
        """Prepare to draw.

        Args:
            corpus: Holds the features of the clips.
            clips: To draw from.
            max_frames: Longest window.
            mirror: Share of mirrored windows.
            statements: Share of windows with a statement for a text.
            deeds: Share of windows drawn by what is done in their clips.
            crop: Share of windows of long clips that are shorter than they could be.
            texts: What is said of a clip.
            other_words: Of which a few are said of it, too.
            seed: Of the draws.
        """
        self._texts, self._other_words = texts, other_words
        self._corpus, self._clips, self._max_frames = corpus, clips, max_frames
        self._mirror, self._statements, self._deeds, self._crop = mirror, statements, deeds, crop
        self._shortest = min(round(_CROP_SECONDS * corpus.fps), max_frames)
        self._rng = np.random.default_rng(seed)
        self._probability = clip_probabilities(clips, 4 * max_frames)
        self._stated = _stated_windows(corpus, clips, max_frames) if statements > 0 else []
        self._done = _clips_by_deed(clips) if deeds > 0 else []
        self._mirror_index, self._mirror_sign = corpus.representation.mirror()
        self._step = _LENGTH_STEP if max_frames % _LENGTH_STEP == 0 else max_frames

    def stated_texts(self) -> set[str]:
        """Return every statement that may be drawn, mirror images left out."""
        windows = (window for of_kind in self._stated for own in of_kind for window in own)
        return {text for window in windows for text in window.texts}

    def batches(self, batch_size: int) -> Iterator[WindowBatch]:
        """Yield batches for ever."""
        while True:
            windows = [self._draw() for _ in range(batch_size * _BUCKET_BATCHES)]
            windows.sort(key=lambda w: w.frames)
            for b in self._rng.permutation(_BUCKET_BATCHES):
                yield self._collate(windows[b * batch_size : (b + 1) * batch_size])

    def _draw(self) -> _Window:
        place = self._rng.random()
        if self._stated and place < self._statements:
            window = self._draw_stated()
        elif self._done and place < self._statements + self._deeds:
            of_deed = self._done[self._rng.integers(len(self._done))]
            window = self._captioned(of_deed[self._rng.integers(len(of_deed))])
        else:
            clip = self._rng.choice(len(self._clips), p=self._probability)
            window = self._captioned(self._clips[clip])
        if self._rng.random() >= self._mirror:
            return window
        return replace(window, texts=tuple(map(mirror_caption, window.texts)), mirrored=True)

    def _captioned(self, clip: Clip) -> _Window:
        frames = min(clip.frames, self._max_frames)
        if clip.frames > self._max_frames and self._rng.random() < self._crop:
            frames = int(self._rng.integers(self._shortest, self._max_frames + 1))
        start = int(self._rng.integers(clip.frames - frames + 1))
        corpus = self._corpus
        features = corpus.of(clip)[start : start + frames]
        texts = (
            name_side(text, features, corpus.representation, corpus.fps)
            for text in (*self._texts(clip), *self._few_other_words(clip))
        )
        return _Window(clip, start, frames, tuple(texts))

    def _few_other_words(self, clip: Clip) -> list[str]:
        every = tuple(self._other_words(clip))
        return [every[i] for i in self._rng.permutation(len(every))[:_OTHER_WORDS]]

    def _draw_stated(self) -> _Window:
        of_kind = self._stated[self._rng.integers(len(self._stated))]
        of_clip = of_kind[self._rng.integers(len(of_kind))]
        return of_clip[self._rng.integers(len(of_clip))]

    def _collate(self, windows: Sequence[_Window]) -> WindowBatch:
        # few distinct lengths, so that compiled kernels are reused
        longest = -(-max(w.frames for w in windows) // self._step) * self._step
        features = np.zeros(
            (len(windows), longest, self._corpus.representation.dim), dtype=np.float32
        )
        for row, w in zip(features, windows, strict=True):
            x = self._corpus.of(w.clip)[w.start : w.start + w.frames]
            if w.reversed:
                motion = self._corpus.representation.decode(x, self._corpus.fps)
                x = self._corpus.representation.encode(motion.reversed())
            if w.mirrored:
                x = x[:, self._mirror_index] * self._mirror_sign
            row[: w.frames] = self._corpus.statistics.normalise(x)
        return WindowBatch(
            torch.from_numpy(features),
            torch.tensor([w.frames for w in windows]),
            [w.texts[self._rng.integers(len(w.texts))] for w in windows],
            [frozenset(w.texts) for w in windows],
        )


def _stated_windows(
    corpus: Corpus, clips: Sequence[Clip], max_frames: int
) -> list[list[list[_Window]]]:
    """Return windows whose kinematics state something, by kind of statement and then by clip."""
    found: dict[str, list[list[_Window]]] = defaultdict(list)
    stride = round(corpus.fps)
    for clip in clips:
        features = corpus.of(clip)
        sizes = {min(round(s * corpus.fps), clip.frames, max_frames) for s in _STATED_SECONDS}
        own: dict[str, list[_Window]] = defaultdict(list)
        for frames in sorted(sizes):
            for start in range(0, clip.frames - frames + 1, stride):
                window = features[start : start + frames]
                for statement in state(window, corpus.representation, corpus.fps):
                    own[statement.kind].append(_Window(clip, start, frames, statement.texts))
                    backward = state_in_reverse(statement)
                    if backward is not None:
                        own[f"{backward.kind}, in reverse"].append(
                            _Window(clip, start, frames, backward.texts, reversed=True)
                        )
        for kind, windows in own.items():
            found[kind].append(windows)
    return [found[kind] for kind in sorted(found)]


def _clips_by_deed(clips: Sequence[Clip]) -> list[list[Clip]]:
    found: dict[str, list[Clip]] = defaultdict(list)
    for clip in clips:
        for deed in deeds_of(*named_deeds(clip)):
            found[deed].append(clip)
    return [found[deed] for deed in sorted(found)]


def clip_probabilities(clips: Sequence[Clip], max_frames: int) -> np.ndarray:
    """Return how often each clip is drawn [len(clips)].

    Data sets have equal shares. Within one a clip counts by the square root of its length (a
    minute-long clip holds more, but its captions say less), and n clips that share their captions
    count as n to the power 0.3: four hundred takes of one gesture would crowd out the bow.
    """
    takes = Counter((clip.dataset, clip.captions) for clip in clips)
    weight = np.array(
        [
            np.sqrt(min(clip.frames, max_frames)) * takes[clip.dataset, clip.captions] ** -0.7
            for clip in clips
        ]
    )
    for dataset in {clip.dataset for clip in clips}:
        own = np.array([clip.dataset == dataset for clip in clips])
        weight[own] /= weight[own].sum()
    return weight / weight.sum()
