"""The trained evaluator: embeds texts and motions, recognises actions, and travels as a folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
import torch

from motiondiffuse_ros.corpus.statements import OPPOSED, statements_of
from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.threads import in_halves
from motiondiffuse_ros.errors import CheckpointError, TextEncoderError
from motiondiffuse_ros.evaluation.config import EvaluatorConfig
from motiondiffuse_ros.evaluation.network import ActionNetwork, TextMotionNetwork
from motiondiffuse_ros.manifest import (
    load_weights,
    read_manifest,
    save_weights,
    shipped,
    write_manifest,
)
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.text import TextEncoder

FORMAT = 1
CRITIC_FOLDER = "critic"
"""Where a checkpoint's folder holds the critic it was trained with."""

_NETWORK, _ACTIONS, _STATISTICS = (
    "text_motion.safetensors",
    "actions.safetensors",
    "statistics.safetensors",
)
_BATCH = 64

_Embed = Callable[[torch.Tensor, torch.Tensor], torch.Tensor]


def shipped_evaluator() -> Path:
    """Return the folder of the ruler: no weights were trained towards it or chosen by it."""
    return shipped("evaluator")


def critic_of(weights: Path) -> Path:
    """Return the folder of the evaluator that plans with some weights choose by.

    It lies with the weights whose training aligned texts with it; others take the shipped one.
    """
    own = weights / CRITIC_FOLDER
    return own if own.is_dir() else shipped("base") / CRITIC_FOLDER


@dataclass(frozen=True, eq=False)
class Evaluator:
    """A ruler for motions; the same for every model that is compared.

    Attributes:
        network: Text and motion encoders.
        recogniser: Of actions; None if no clip it was trained on had one.
        actions: Its classes.
        statistics: Normalisation of the features that both were trained with.
        representation: Name of these features.
        encoder: Frozen text encoder.
        sha256: Hash of the text-motion weights; empty before saving.
    """

    network: TextMotionNetwork = field(repr=False)
    recogniser: ActionNetwork | None = field(repr=False)
    actions: tuple[str, ...]
    statistics: Statistics = field(repr=False)
    representation: str
    encoder: TextEncoder = field(repr=False)
    sha256: str = ""

    @cached_property
    def statements(self) -> Array:
        """Unit vectors of opposed statements [S, space]; they are the same for every request."""
        return self.embed_texts(statements_of(OPPOSED))

    @torch.inference_mode()
    def embed_texts(self, texts: Sequence[str]) -> Array:
        """Return unit vectors [N, space]."""
        rows = []
        for start in range(0, len(texts), _BATCH):
            tokens = self.encoder.encode(texts[start : start + _BATCH])
            rows.append(self.network.embed_text(tokens.states, tokens.mask))
        return torch.cat(rows).numpy()

    def embed_motions(self, features: Sequence[Array]) -> Array:
        """Return unit vectors [N, space] of motions given as features [T, D], not normalised."""
        return self._over(features, self.network.embed_motion)

    def embed_actions(self, features: Sequence[Array]) -> Array:
        """Return the recogniser's last hidden vectors [N, space]."""
        return self._over(features, self._known_actions().embed)

    def recognise(self, features: Sequence[Array]) -> Array:
        """Return the index in `actions` that each motion is taken for [N]."""
        return self._over(features, self._known_actions()).argmax(axis=-1)

    def _known_actions(self) -> ActionNetwork:
        if self.recogniser is None:
            raise CheckpointError("this evaluator was trained on clips without actions")
        return self.recogniser

    @torch.inference_mode()
    def _over(self, features: Sequence[Array], embed: _Embed) -> Array:
        # by length, so that batches have little padding; the last frames of a long one are cut
        longest = self.network.config.max_frames
        order = sorted(range(len(features)), key=lambda i: len(features[i]))
        rows: list[Array] = [np.empty(0)] * len(features)
        for start in range(0, len(order), _BATCH):
            batch = order[start : start + _BATCH]
            cut = [self.statistics.normalise(features[i][:longest]) for i in batch]
            for i, row in zip(batch, _embedded(cut, embed).numpy(), strict=True):
                rows[i] = row
        return np.stack(rows)

    def save_pretrained(self, folder: Path) -> None:
        """Write the folder; weights in float16."""
        folder.mkdir(parents=True, exist_ok=True)
        save_weights(self.network, folder / _NETWORK)
        files = [_NETWORK, _STATISTICS]
        if self.recogniser is not None:
            save_weights(self.recogniser, folder / _ACTIONS)
            files.append(_ACTIONS)
        self.statistics.save(folder / _STATISTICS)
        config = {
            "format": FORMAT,
            "evaluator": self.network.config.to_dict(),
            "actions": list(self.actions),
            "representation": self.representation,
            "text_encoder_sha256": self.encoder.sha256,
        }
        write_manifest(folder, config, files)

    @classmethod
    def from_pretrained(cls, folder: Path, encoder: TextEncoder) -> Evaluator:
        """Read an evaluator folder; no pickles, and every file must have its recorded hash.

        Raises:
            CheckpointError: If a file is missing, truncated, altered or of another format.
            TextEncoderError: If it was trained with another text encoder.
        """
        folder = Path(folder)
        manifest = read_manifest(
            folder,
            what="evaluator",
            format=FORMAT,
            fields=("evaluator", "actions", "representation", "text_encoder_sha256"),
            files=(_NETWORK, _STATISTICS),
        )
        if manifest["text_encoder_sha256"] != encoder.sha256:
            raise TextEncoderError(
                f"evaluator {folder} was trained with {manifest['text_encoder_sha256'][:12]}…, "
                f"not with {encoder.name} {encoder.sha256[:12]}…"
            )
        config = EvaluatorConfig.from_dict(manifest["evaluator"])
        actions = tuple(manifest["actions"])
        recogniser = None
        if actions:
            recogniser = load_weights(
                lambda: ActionNetwork(config, len(actions)), folder / _ACTIONS, what="evaluator"
            )
        return cls(
            load_weights(lambda: TextMotionNetwork(config), folder / _NETWORK, what="evaluator"),
            recogniser,
            actions,
            Statistics.load(folder / _STATISTICS),
            manifest["representation"],
            encoder,
            manifest["files"][_NETWORK],
        )


def _embedded(motions: Sequence[Array], embed: _Embed) -> torch.Tensor:
    """Return the vectors of one batch of normalised features."""
    lengths = torch.tensor([len(x) for x in motions])
    padded = torch.nn.utils.rnn.pad_sequence(
        [torch.from_numpy(np.asarray(x, dtype=np.float32)) for x in motions], batch_first=True
    )
    return in_halves(lambda some: embed(padded[some], lengths[some]), len(motions))
