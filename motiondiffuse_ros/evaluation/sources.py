"""Where compared motions come from: data, what a user could do without a model, and a model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from motiondiffuse_ros.corpus.store import Clip, Corpus
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.evaluation.items import MIN_FRAMES, draw_window
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.text import TextEncoder


class MotionSource(Protocol):
    """Answers texts with motions.

    Attributes:
        name: In tables.
        generates: Whether another seed gives another motion for the same text.
    """

    name: str
    generates: bool

    def motions(
        self, texts: Sequence[str], frames: Sequence[int], seed: int, own: Sequence[Clip]
    ) -> list[Array]:
        """Return the features [at most frames, D] of one motion for each text.

        Args:
            texts: What is asked for.
            frames: Wanted lengths.
            seed: Of all draws.
            own: The clip that each text belongs to, which is no answer to it.
        """
        ...


class RandomClip:
    """A random clip, whatever the text: what any useful answer must beat."""

    name, generates = "random", False

    def __init__(self, corpus: Corpus, clips: Sequence[Clip]) -> None:
        self._corpus = corpus
        self._clips = [clip for clip in clips if clip.frames >= MIN_FRAMES]

    def motions(
        self, texts: Sequence[str], frames: Sequence[int], seed: int, own: Sequence[Clip]
    ) -> list[Array]:
        """Return windows of clips drawn with the same chance each."""
        rng = np.random.default_rng(seed)
        answers = []
        for f, clip in zip(frames, own, strict=True):
            chosen = int(rng.integers(len(self._clips)))
            if self._clips[chosen] is clip:
                chosen = (chosen + 1) % len(self._clips)
            answers.append(draw_window(self._corpus, self._clips[chosen], f, rng))
        return answers


class NearestCaption:
    """The clip whose caption is nearest in the space of the text encoder.

    Where several clips share the caption one of them is drawn.
    """

    name, generates = "retrieval", False

    def __init__(self, corpus: Corpus, clips: Sequence[Clip], encoder: TextEncoder) -> None:
        self._corpus, self._encoder = corpus, encoder
        self._owners: dict[str, list[Clip]] = {}
        for clip in clips:
            if clip.frames >= MIN_FRAMES:
                for caption in clip.captions:
                    self._owners.setdefault(caption, []).append(clip)
        self._captions = sorted(self._owners)
        self._vectors = self._pooled(self._captions)

    def motions(
        self, texts: Sequence[str], frames: Sequence[int], seed: int, own: Sequence[Clip]
    ) -> list[Array]:
        """Return a window of a clip with the nearest caption."""
        rng = np.random.default_rng(seed)
        near = self._pooled(texts) @ self._vectors.T
        answers = []
        for row, f, clip in zip(near, frames, own, strict=True):
            owners = self._nearest_owners(row, clip)
            answers.append(draw_window(self._corpus, owners[rng.integers(len(owners))], f, rng))
        return answers

    def _nearest_owners(self, near: Array, clip: Clip) -> list[Clip]:
        for caption in np.argsort(-near):
            owners = [c for c in self._owners[self._captions[caption]] if c is not clip]
            if owners:
                return owners
        return [clip]  # a corpus of one clip

    def _pooled(self, texts: Sequence[str]) -> Array:
        starts = range(0, len(texts), 256)
        rows = [self._encoder.encode(texts[s : s + 256]).pooled().numpy() for s in starts]
        return np.concatenate(rows)


class Model:
    """A checkpoint: its samples as users get them, decoded to a motion and encoded again."""

    name, generates = "generated", True

    def __init__(
        self,
        pipeline: MotionPipeline,
        config: SamplerConfig,
        on_progress: Callable[[int, int], None] | None = None,
    ) -> None:
        self._pipeline, self._config, self._on_progress = pipeline, config, on_progress

    def motions(
        self, texts: Sequence[str], frames: Sequence[int], seed: int, own: Sequence[Clip]
    ) -> list[Array]:
        """Return samples of the model."""
        motions = self._pipeline.batch(
            texts, frames, config=self._config, seed=seed, on_progress=self._on_progress
        )
        return [self._pipeline.representation.encode(motion) for motion in motions]
