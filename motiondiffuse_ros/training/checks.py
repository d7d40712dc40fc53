"""What is refused before training begins."""

from __future__ import annotations

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.errors import CheckpointError


def check_representation(corpus: Corpus, config: DenoiserConfig) -> None:
    """Raise CheckpointError if a corpus does not speak the denoiser's representation."""
    if corpus.representation.name != config.representation:
        raise CheckpointError(
            f"the denoiser speaks {config.representation}, the corpus holds "
            f"{corpus.representation.name}, which cannot be trained on yet"
        )
