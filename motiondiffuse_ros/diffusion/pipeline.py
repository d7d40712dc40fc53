"""Texts in, motions out: encoder, composition, sampler and decoder behind one call."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.composition import TimedText, compose
from motiondiffuse_ros.diffusion.constraints import (
    Constraint,
    Eased,
    KeptFeatures,
    OnPlainFeatures,
)
from motiondiffuse_ros.diffusion.denoiser import Conditioning, Denoiser
from motiondiffuse_ros.diffusion.denoising import Planting
from motiondiffuse_ros.diffusion.few_steps import FewSteps
from motiondiffuse_ros.diffusion.sampler import Early, sample, sample_batch
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import CheckpointError, RequestError, TextEncoderError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.features import REPRESENTATIONS, PoseState, Representation
from motiondiffuse_ros.motion.planted_feet import WHILE_DENOISING, PlantedFeet
from motiondiffuse_ros.motion.root_path import PathPoint, RootPath
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.text import TextEncoder, TokenStates, load_text_encoder
from motiondiffuse_ros.text.remembered import Remembered

EASE = 0.6
"""Time in which the difference between kept and predicted frames dies away next to them [s]."""

_BATCH_ROWS = 32


@dataclass(frozen=True)
class Samples:
    """What a pipeline returns.

    Attributes:
        motions: One per candidate that went on; starts over the origin, facing +x.
        candidates: Which those are, rising.
        text_seconds: Time spent on the text encoder, s.
        sampling_seconds: Time spent on denoising, s.
    """

    motions: tuple[Motion, ...]
    candidates: tuple[int, ...]
    text_seconds: float
    sampling_seconds: float


class MotionPipeline:
    """A checkpoint with its text encoder, ready to sample."""

    def __init__(self, checkpoint: Checkpoint, encoder: TextEncoder) -> None:
        """Join a checkpoint and an encoder.

        Raises:
            TextEncoderError: If the checkpoint was trained with another encoder.
            CheckpointError: If its representation is unknown.
        """
        config = checkpoint.denoiser.config
        trained_with = (config.text_encoder, checkpoint.text_encoder_sha256)
        if trained_with != (encoder.name, encoder.sha256):
            raise TextEncoderError(
                f"these weights were trained with {trained_with[0]} {trained_with[1][:12]}…, "
                f"not with {encoder.name} {encoder.sha256[:12]}…"
            )
        if config.representation not in REPRESENTATIONS:
            raise CheckpointError(
                f"unknown representation '{config.representation}'; known: "
                f"{', '.join(REPRESENTATIONS)}"
            )
        self._checkpoint, self._encoder = checkpoint, Remembered(encoder)
        self._representation: Representation = REPRESENTATIONS[config.representation]()
        self._unconditional: dict[Denoiser, Conditioning] = {}

    @classmethod
    def from_pretrained(
        cls, folder: Path, text_encoder: Path | None = None, *, device: str = "cpu"
    ) -> MotionPipeline:
        """Load a checkpoint folder and the encoder it names.

        Args:
            folder: The checkpoint.
            text_encoder: Folder of the encoder's files, where they do not come with a package.
            device: Torch device of the denoiser.

        Raises:
            CheckpointError: If the checkpoint or the device cannot be used.
            TextEncoderError: If the encoder cannot be used.
        """
        checkpoint = Checkpoint.from_pretrained(folder)
        try:
            checkpoint.denoiser.to(device)
        except (RuntimeError, AssertionError) as error:
            raise CheckpointError(f"device '{device}' cannot be used: {error}") from error
        name = checkpoint.denoiser.config.text_encoder
        return cls(checkpoint, load_text_encoder(name, text_encoder))

    @property
    def fps(self) -> float:
        """Frame rate of the motions, Hz."""
        return self._checkpoint.denoiser.config.fps

    @property
    def max_frames(self) -> int:
        """Longest window that is sampled at once, frames."""
        return self._checkpoint.denoiser.config.max_frames

    @property
    def encoder(self) -> TextEncoder:
        """The frozen text encoder."""
        return self._encoder

    @property
    def representation(self) -> Representation:
        """What the model's features mean."""
        return self._representation

    @property
    def weights_sha256(self) -> str:
        """Hash of the weights file."""
        return self._checkpoint.sha256

    def few_steps(self, config: SamplerConfig) -> int | None:
        """Return in how many steps the weights were taught to do what a sampler does in more."""
        few = self._checkpoint.few_steps
        return None if few is None or not few.stand_for.fit(config) else few.stand_for.steps

    def _few_steps_for(self, config: SamplerConfig) -> FewSteps | None:
        """Return the weights for few steps, if a sampler asks for as many."""
        return self._checkpoint.few_steps if config.steps == self.few_steps(config) else None

    def few_steps_sha256(self, config: SamplerConfig) -> str:
        """Return the hash of the weights that do the first steps of a sampler; empty if none do."""
        few = self._few_steps_for(config)
        return "" if few is None else few.sha256

    def on_path(self, points: Sequence[PathPoint], frames: int) -> Constraint:
        """Return the constraint that the root passes points; see `RootPath`.

        Raises:
            RequestError: If the model's representation has no root path that can be bent.
        """
        if not isinstance(self._representation, PoseState):
            raise RequestError(
                f"these weights speak {self._representation.name}; keeping to places in the world "
                f"needs weights of {PoseState.name}"
            )
        path = RootPath(points, frames, self.fps)
        return OnPlainFeatures(path, self._checkpoint.statistics)

    def keeping(self, motion: Motion, mask: NDArray[np.bool_]) -> Constraint:
        """Return the constraint that some features are those of a motion.

        Args:
            motion: At the model's frame rate, as long as what is sampled.
            mask: [T, D], bool.
        """
        mask_values = torch.from_numpy(mask.astype("float32"))
        return KeptFeatures(self._encoded(motion), mask_values.to(self._checkpoint.denoiser.device))

    def easing(self, motion: Motion, rows: NDArray[np.bool_]) -> Constraint:
        """Return the constraint that frames next to those of a motion go on from them.

        Args:
            motion: At the model's frame rate, as long as what is sampled.
            rows: Frames that are kept [T], bool.
        """
        kept = torch.from_numpy(rows).to(self._checkpoint.denoiser.device)
        return Eased(self._encoded(motion), kept, round(EASE * self.fps))

    def _encoded(self, motion: Motion) -> torch.Tensor:
        values = self._checkpoint.statistics.normalise(self._representation.encode(motion))
        return torch.from_numpy(values.astype("float32")).to(self._checkpoint.denoiser.device)

    def __call__(
        self,
        texts: tuple[TimedText, ...],
        frames: int,
        *,
        config: SamplerConfig,
        candidates: int,
        seed: int,
        blend_frames: int,
        constraints: Sequence[Constraint] = (),
        choose: Callable[[Sequence[Array]], Sequence[int]] | None = None,
        on_step: Callable[[int, int], None] | None = None,
        cancelled: Callable[[], bool] | None = None,
    ) -> Samples:
        """Sample candidates of one timeline; see `compose` and `sample`.

        `choose` is given the features [T, D], not normalised, that each candidate is predicted to
        have, and returns which go on.
        """

        def chosen(clean: torch.Tensor) -> Sequence[int]:
            assert choose is not None
            return choose(list(self._checkpoint.statistics.denormalise(clean.cpu().numpy())))

        denoiser = self._checkpoint.denoiser
        windows = compose(
            texts,
            frames,
            self._representation,
            max_frames=denoiser.config.max_frames,
            blend_frames=blend_frames,
        )
        began = time.perf_counter()
        distinct = list(dict.fromkeys(w.text for w in windows))
        given = self._given(distinct, config)
        encoded = time.perf_counter()
        sampled = sample(
            denoiser,
            windows,
            *given,
            frames=frames,
            candidates=candidates,
            seed=seed,
            text_of=[distinct.index(w.text) for w in windows],
            constraints=constraints,
            planted=self._planted(),
            choose=chosen if choose else None,
            on_step=on_step,
            cancelled=cancelled,
        )
        motions = tuple(map(self._decode, sampled.features))
        return Samples(
            motions,
            sampled.candidates,
            encoded - began,
            time.perf_counter() - encoded,
        )

    def batch(
        self,
        texts: Sequence[str],
        frames: Sequence[int],
        *,
        config: SamplerConfig,
        seed: int,
        on_progress: Callable[[int, int], None] | None = None,
    ) -> list[Motion]:
        """Sample one motion for each of many texts; see `sample_batch`.

        Args:
            texts: Conditions.
            frames: Length of each motion, at most `max_frames`.
            config: Sampler.
            seed: Of all noise.
            on_progress: Called with (motions done, motions in all).
        """
        order = sorted(range(len(texts)), key=lambda i: frames[i])  # like lengths share a batch
        motions: dict[int, Motion] = {}
        for start in range(0, len(order), _BATCH_ROWS):
            rows = order[start : start + _BATCH_ROWS]
            features = sample_batch(
                self._checkpoint.denoiser,
                torch.tensor([frames[i] for i in rows]),
                *self._given([texts[i] for i in rows], config),
                seed=seed + start,  # batches must not share their noise
                planted=self._planted(),
            )
            for i, row in zip(rows, features, strict=True):
                motions[i] = self._decode(row[: frames[i]])
            if on_progress is not None:
                on_progress(len(motions), len(texts))
        return [motions[i] for i in range(len(texts))]

    def _planted(self) -> Planting | None:
        if not isinstance(self._representation, PoseState):
            return None
        return Planting(
            *(
                OnPlainFeatures(PlantedFeet(self.fps, weights), self._checkpoint.statistics)
                for weights in (WHILE_DENOISING, None)
            )
        )

    def _given(
        self, texts: Sequence[str], config: SamplerConfig
    ) -> tuple[Conditioning, Conditioning, SamplerConfig, Early | None]:
        """Return what sampling is given of texts and of the empty one, and the sampler to use."""
        tokens = self._encoder.encode(texts)

        def conditioned(denoiser: Denoiser) -> tuple[Conditioning, Conditioning]:
            if denoiser not in self._unconditional:  # the same for every request
                self._unconditional[denoiser] = _condition(denoiser, self._encoder.encode([""]))
            return _condition(denoiser, tokens), self._unconditional[denoiser]

        few = self._few_steps_for(config)
        own = conditioned(self._checkpoint.denoiser)
        if few is None:
            return *own, config, None
        student = few.denoiser.to(own[0].pooled.device)
        early = Early(student, *conditioned(student), few.stand_for.taught[-1])
        return *own, few.stand_for.sampler(config), early

    def _decode(self, features: torch.Tensor) -> Motion:
        clean = self._checkpoint.statistics.denormalise(features.cpu().numpy())
        return self._representation.decode(clean, self.fps)


@torch.inference_mode()
def _condition(denoiser: Denoiser, tokens: TokenStates) -> Conditioning:
    return denoiser.condition(tokens.states.to(denoiser.device), tokens.mask.to(denoiser.device))
