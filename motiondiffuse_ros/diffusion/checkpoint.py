"""Checkpoints: a folder with config.json, model.safetensors and statistics.safetensors."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import torch

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.manifest import load_weights, read_manifest, save_weights, write_manifest

FORMAT = 1
MODEL_FILE = "model.safetensors"
STATISTICS_FILE = "statistics.safetensors"


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """Weights with everything needed to use them.

    Attributes:
        denoiser: In evaluation mode, float32.
        statistics: Normalisation of its features.
        text_encoder_sha256: Hash of the frozen encoder it was trained with.
        sha256: Hash of the weights file; empty before saving.
    """

    denoiser: Denoiser = field(repr=False)
    statistics: Statistics = field(repr=False)
    text_encoder_sha256: str
    sha256: str = ""

    def save_pretrained(self, folder: Path, dtype: torch.dtype = torch.float16) -> None:
        """Write the folder; weights in `dtype`."""
        folder.mkdir(parents=True, exist_ok=True)
        save_weights(self.denoiser, folder / MODEL_FILE, dtype)
        self.statistics.save(folder / STATISTICS_FILE)
        config = {
            "format": FORMAT,
            "denoiser": self.denoiser.config.to_dict(),
            "text_encoder_sha256": self.text_encoder_sha256,
        }
        write_manifest(folder, config, (MODEL_FILE, STATISTICS_FILE))

    @classmethod
    def from_pretrained(cls, folder: Path) -> Checkpoint:
        """Read a checkpoint folder; no pickles, and every file must have its recorded hash.

        Raises:
            CheckpointError: If a file is missing, truncated, altered or of another format.
        """
        folder = Path(folder)
        config = read_manifest(
            folder,
            what="checkpoint",
            format=FORMAT,
            fields=("denoiser", "text_encoder_sha256"),
            files=(MODEL_FILE, STATISTICS_FILE),
        )
        denoiser_config = DenoiserConfig.from_dict(config["denoiser"])
        path = folder / MODEL_FILE
        denoiser = load_weights(lambda: Denoiser(denoiser_config), path, what="checkpoint")
        return cls(
            denoiser,
            Statistics.load(folder / STATISTICS_FILE),
            config["text_encoder_sha256"],
            config["files"][MODEL_FILE],
        )
