"""Checkpoints: a folder with config.json, model.safetensors and statistics.safetensors.

Weights that were taught to need few steps lie beside them, as few_steps.safetensors.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import torch

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.diffusion.few_steps import FewSteps, FewStepsOf
from motiondiffuse_ros.errors import CheckpointError
from motiondiffuse_ros.manifest import load_weights, read_manifest, save_weights, write_manifest

FORMAT = 1
MODEL_FILE = "model.safetensors"
STATISTICS_FILE = "statistics.safetensors"
FEW_STEPS_FILE = "few_steps.safetensors"


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """Weights with everything needed to use them.

    Attributes:
        denoiser: In evaluation mode, float32.
        statistics: Normalisation of its features.
        text_encoder_sha256: Hash of the frozen encoder it was trained with.
        sha256: Hash of the weights file; empty before saving.
        few_steps: Weights that do the same in few steps, if there are such.
    """

    denoiser: Denoiser = field(repr=False)
    statistics: Statistics = field(repr=False)
    text_encoder_sha256: str
    sha256: str = ""
    few_steps: FewSteps | None = field(default=None, repr=False)

    def save_pretrained(self, folder: Path, dtype: torch.dtype = torch.float16) -> None:
        """Write the folder; weights in `dtype`."""
        folder.mkdir(parents=True, exist_ok=True)
        save_weights(self.denoiser, folder / MODEL_FILE, dtype)
        self.statistics.save(folder / STATISTICS_FILE)
        config: dict[str, Any] = {
            "format": FORMAT,
            "denoiser": self.denoiser.config.to_dict(),
            "text_encoder_sha256": self.text_encoder_sha256,
        }
        files = [MODEL_FILE, STATISTICS_FILE]
        if self.few_steps is not None:
            save_weights(self.few_steps.denoiser, folder / FEW_STEPS_FILE, dtype)
            config["few_steps"] = self.few_steps.stand_for.to_dict()
            files.append(FEW_STEPS_FILE)
        write_manifest(folder, config, files)

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

        def load(name: str) -> Denoiser:
            return load_weights(lambda: Denoiser(denoiser_config), folder / name, what="checkpoint")

        few = None
        if "few_steps" in config:
            if FEW_STEPS_FILE not in config["files"]:
                raise CheckpointError(
                    f"checkpoint {folder}: few steps without a {FEW_STEPS_FILE} of known hash"
                )
            few = FewSteps(
                partial(load, FEW_STEPS_FILE),  # most who start never ask for it
                FewStepsOf.from_dict(config["few_steps"]),
                config["files"][FEW_STEPS_FILE],
            )
        return cls(
            load(MODEL_FILE),
            Statistics.load(folder / STATISTICS_FILE),
            config["text_encoder_sha256"],
            config["files"][MODEL_FILE],
            few,
        )
