"""CLIP ViT-B/32, the paper's text encoder (512 wide), from a folder the user has."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import torch

from motiondiffuse_ros.errors import TextEncoderError
from motiondiffuse_ros.hashing import file_sha256
from motiondiffuse_ros.text.encoder import TokenStates, sort_out_padding


class Clip:
    """Token states of CLIP's text transformer; frozen."""

    name = "clip"
    dim = 512

    def __init__(self, folder: Path) -> None:
        """Load the model from a local folder in Hugging Face's layout.

        Args:
            folder: Holds config.json, model.safetensors and the tokenizer's files, as in
                openai/clip-vit-base-patch32.

        Raises:
            TextEncoderError: If files are missing or the text width is not 512.
        """
        from transformers import CLIPTextModel, CLIPTokenizer

        try:
            self.sha256 = file_sha256(Path(folder) / "model.safetensors")
            self._tokenizer = CLIPTokenizer.from_pretrained(folder, local_files_only=True)
            self._model = CLIPTextModel.from_pretrained(folder, local_files_only=True).eval()
        except (OSError, ValueError) as error:
            raise TextEncoderError(
                f"{folder}: no CLIP ViT-B/32 in Hugging Face's layout "
                f"(config.json, model.safetensors, tokenizer files): {error}"
            ) from error
        if self._model.config.hidden_size != self.dim:
            raise TextEncoderError(
                f"{folder}: text width {self._model.config.hidden_size}, ViT-B/32 has {self.dim}"
            )

    @torch.inference_mode()
    def encode(self, texts: Sequence[str]) -> TokenStates:
        """Return token states [N, L, 512]."""
        tokens = self._tokenizer(list(texts), padding=True, truncation=True, return_tensors="pt")
        states = self._model(**tokens).last_hidden_state
        return sort_out_padding(states, tokens["attention_mask"])
