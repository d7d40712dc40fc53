"""Checkpoints: a folder with config.json, model.safetensors and statistics.safetensors."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.errors import CheckpointError
from motiondiffuse_ros.hashing import file_sha256

FORMAT = 1
MODEL_FILE = "model.safetensors"
STATISTICS_FILE = "statistics.safetensors"
CONFIG_FILE = "config.json"


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
        tensors = {
            name: value.detach().to(dtype).contiguous()
            for name, value in self.denoiser.state_dict().items()
        }
        save_file(tensors, folder / MODEL_FILE)
        self.statistics.save(folder / STATISTICS_FILE)
        config = {
            "format": FORMAT,
            "denoiser": self.denoiser.config.to_dict(),
            "text_encoder_sha256": self.text_encoder_sha256,
            "files": {name: file_sha256(folder / name) for name in (MODEL_FILE, STATISTICS_FILE)},
        }
        (folder / CONFIG_FILE).write_text(json.dumps(config, indent=2) + "\n", encoding="utf-8")

    @classmethod
    def from_pretrained(cls, folder: Path) -> Checkpoint:
        """Read a checkpoint folder; no pickles, and every file must have its recorded hash.

        Raises:
            CheckpointError: If a file is missing, truncated, altered or of another format.
        """
        folder = Path(folder)
        config = _read_config(folder)
        hashes = {}
        for name, expected in config["files"].items():
            try:
                hashes[name] = file_sha256(folder / name)
            except OSError as error:
                raise CheckpointError(f"checkpoint {folder}: {name} is missing") from error
            if hashes[name] != expected:
                raise CheckpointError(
                    f"checkpoint {folder}: {name} is truncated or altered "
                    f"(SHA-256 {hashes[name][:12]}…, config.json says {expected[:12]}…)"
                )
        denoiser = Denoiser(DenoiserConfig.from_dict(config["denoiser"]))
        try:
            tensors = load_file(folder / MODEL_FILE)
            denoiser.load_state_dict({k: v.float() for k, v in tensors.items()})
        except (OSError, SafetensorError, RuntimeError) as error:
            raise CheckpointError(
                f"checkpoint {folder}: {MODEL_FILE} does not fit its config.json ({error})"
            ) from error
        return cls(
            denoiser.eval(),
            Statistics.load(folder / STATISTICS_FILE),
            config["text_encoder_sha256"],
            hashes[MODEL_FILE],
        )


def _read_config(folder: Path) -> dict:
    try:
        config = json.loads((folder / CONFIG_FILE).read_text(encoding="utf-8"))
    except OSError as error:
        raise CheckpointError(
            f"checkpoint {folder}: no {CONFIG_FILE}; a checkpoint is a folder with {CONFIG_FILE}, "
            f"{MODEL_FILE} and {STATISTICS_FILE}"
        ) from error
    except ValueError as error:
        raise CheckpointError(
            f"checkpoint {folder}: {CONFIG_FILE} is not JSON ({error})"
        ) from error
    wanted = {"format", "denoiser", "text_encoder_sha256", "files"}
    if not isinstance(config, dict) or not wanted <= set(config):
        raise CheckpointError(f"checkpoint {folder}: {CONFIG_FILE} needs {sorted(wanted)}")
    if config["format"] != FORMAT:
        raise CheckpointError(
            f"checkpoint {folder}: format {config['format']}, this version reads {FORMAT}"
        )
    if not {MODEL_FILE, STATISTICS_FILE} <= set(config["files"]):
        raise CheckpointError(f"checkpoint {folder}: {CONFIG_FILE} gives no hashes of its files")
    return config
