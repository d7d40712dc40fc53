"""Many composed requests sampled at once, for the composition benchmarks.

Requests are laid one after the other on one time axis. Windows of different requests never overlap,
so nothing passes from one to another, and one batch of windows serves them all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
from rich.progress import track

from benchmarks.composition_lists import Entry
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.composition import TimedText, Window, compose
from motiondiffuse_ros.diffusion.sampler import sample
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.motion.features import REPRESENTATIONS
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.text import load_text_encoder

_GROUP_WINDOWS = 24


@dataclass(frozen=True)
class Request:
    """Windows whose weights sum to one, and how many frames they cover."""

    windows: tuple[Window, ...]
    frames: int


class Composer:
    """A checkpoint that answers composed requests with features as they were sampled."""

    def __init__(self, weights: Path, config: SamplerConfig, seed: int, blend_seconds: float):
        """Load the weights.

        Args:
            weights: Checkpoint folder.
            config: Sampler; what concerns composition is set by each call.
            seed: Of all noise; every call draws the same.
            blend_seconds: Time over which neighbours are blended.

        Raises:
            CheckpointError: If the weights cannot be used.
        """
        self._checkpoint = Checkpoint.from_pretrained(weights)
        shape = self._checkpoint.denoiser.config
        self._encoder = load_text_encoder(shape.text_encoder)
        self.representation = REPRESENTATIONS[shape.representation]()
        self.fps, self.sha256 = shape.fps, self._checkpoint.sha256
        self._max_frames = shape.max_frames
        self._config, self._seed = config, seed
        self._blend = round(blend_seconds * self.fps)

    def timed(self, entry: Entry) -> tuple[TimedText, ...]:
        """Return the texts of an entry in frames."""
        return tuple(
            TimedText(p.text, round(p.start * self.fps), round(p.end * self.fps), p.parts)
            for p in entry.pieces
        )

    def frames(self, entry: Entry) -> int:
        """Return the number of frames of an entry."""
        return round(entry.seconds * self.fps)

    def request(
        self, texts: Sequence[TimedText], frames: int, blend_frames: int | None = None
    ) -> Request:
        """Compose texts as the planner does."""
        windows = compose(
            tuple(texts),
            frames,
            self.representation,
            max_frames=self._max_frames,
            blend_frames=self._blend if blend_frames is None else blend_frames,
        )
        return Request(windows, frames)

    def sample(
        self,
        requests: Sequence[Request],
        what: str,
        *,
        part_correction: float = 0.0,
        time_correction: float = 0.0,
        apart_above: float = 1.0,
    ) -> list[Array]:
        """Return the features [frames, D] of each request, not normalised."""
        config = replace(
            self._config,
            part_correction=part_correction,
            time_correction=time_correction,
            apart_above=apart_above,
        )
        out: list[Array] = []
        for group in track(_groups(requests), what, transient=True):
            out += self._sample_group(group, config, self._seed + len(out))
        return out

    def paste(self, requests: Sequence[Request], what: str) -> list[Array]:
        """Return the windows of each request sampled alone and put together afterwards.

        The same weights as `sample` has, but on finished motions instead of predictions: hard cuts
        or linear blends in time, other parts' features in space.
        """
        alone = [
            Request((Window(w.text, 0, np.ones_like(w.weight), w.parts),), len(w.weight))
            for request in requests
            for w in request.windows
        ]
        samples = iter(self.sample(alone, what))
        out = []
        for request in requests:
            whole = np.zeros((request.frames, self.representation.dim))
            for window in request.windows:
                whole[window.start : window.stop] += window.weight * next(samples)
            out.append(whole)
        return out

    def _sample_group(
        self, group: Sequence[Request], config: SamplerConfig, seed: int
    ) -> list[Array]:
        starts = np.concatenate([[0], np.cumsum([r.frames for r in group])])
        windows = [
            replace(w, start=w.start + int(start))
            for request, start in zip(group, starts[:-1], strict=True)
            for w in request.windows
        ]
        tokens = self._encoder.encode([*(w.text for w in windows), ""])
        denoiser = self._checkpoint.denoiser
        with torch.inference_mode():
            every = denoiser.condition(tokens.states, tokens.mask)
        features = sample(
            denoiser,
            windows,
            every.expand(torch.arange(len(windows))),
            every.expand(torch.tensor([len(windows)])),
            config,
            frames=int(starts[-1]),
            candidates=1,
            seed=seed,
        ).features[0]
        clean = self._checkpoint.statistics.denormalise(features.numpy())
        return [clean[a:b] for a, b in pairwise(starts)]


def _groups(requests: Sequence[Request]) -> list[list[Request]]:
    """Return the requests in order, in groups of about `_GROUP_WINDOWS` windows."""
    groups: list[list[Request]] = []
    count = _GROUP_WINDOWS
    for request in requests:
        if count + len(request.windows) > _GROUP_WINDOWS:
            groups.append([])
            count = 0
        groups[-1].append(request)
        count += len(request.windows)
    return groups
