"""Frozen text encoders."""

from __future__ import annotations

from pathlib import Path

from motiondiffuse_ros.errors import TextEncoderError
from motiondiffuse_ros.text.encoder import TextEncoder, TokenStates

TEXT_ENCODERS = ("minilm", "clip")

__all__ = ["TEXT_ENCODERS", "TextEncoder", "TokenStates", "load_text_encoder"]


def load_text_encoder(name: str, folder: Path | None = None) -> TextEncoder:
    """Load a text encoder by name.

    Args:
        name: "minilm" (its files come with a package) or "clip" (needs a folder).
        folder: Local folder of the encoder's files, for "clip".

    Raises:
        TextEncoderError: If there is no such encoder or its files are missing.
    """
    if name == "minilm":
        from motiondiffuse_ros.text.minilm import MiniLM

        return MiniLM()
    if name == "clip":
        if folder is None:
            raise TextEncoderError("the text encoder 'clip' needs the folder of its weights")
        from motiondiffuse_ros.text.clip import Clip

        return Clip(folder)
    raise TextEncoderError(f"unknown text encoder '{name}'; known: {', '.join(TEXT_ENCODERS)}")
