"""BERT's encoder, which MiniLM is, under the names of its published weights.

The same class of the transformers package takes two seconds and 60 MB to import.
"""

from __future__ import annotations

from pathlib import Path

from safetensors.torch import load_file
from torch import Tensor
from torch.nn import functional as F

_EPS = 1e-12
_HEADS = 12


class Bert:
    """Token states of a BERT; in evaluation mode, float32."""

    def __init__(self, weights: Path) -> None:
        """Read the weights.

        Args:
            weights: Safetensors under Hugging Face's names.
        """
        self._weights = load_file(weights)
        prefixes = {n.split(".")[2] for n in self._weights if n.startswith("encoder.layer.")}
        self._layers = [f"encoder.layer.{i}" for i in range(len(prefixes))]

    def __call__(self, ids: Tensor, mask: Tensor) -> Tensor:
        """Return the last states [N, L, D] of tokens [N, L].

        Args:
            ids: Of the tokens.
            mask: [N, L], 1 on tokens.
        """
        table = "embeddings.{}_embeddings.weight"
        x = F.embedding(ids, self._weights[table.format("word")])
        x = x + self._weights[table.format("token_type")][0]
        x = x + self._weights[table.format("position")][: ids.shape[1]]
        x = self._norm(x, "embeddings.LayerNorm")
        attended = mask.bool()[:, None, None, :]
        for layer in self._layers:
            x = self._norm(
                x + self._attention(x, attended, layer), f"{layer}.attention.output.LayerNorm"
            )
            hidden = F.gelu(self._linear(x, f"{layer}.intermediate.dense"))
            x = self._norm(
                x + self._linear(hidden, f"{layer}.output.dense"), f"{layer}.output.LayerNorm"
            )
        return x

    def _attention(self, x: Tensor, attended: Tensor, layer: str) -> Tensor:
        query, key, value = (
            self._linear(x, f"{layer}.attention.self.{name}")
            .unflatten(-1, (_HEADS, -1))
            .transpose(1, 2)
            for name in ("query", "key", "value")
        )
        y = F.scaled_dot_product_attention(query, key, value, attended)
        return self._linear(y.transpose(1, 2).flatten(2), f"{layer}.attention.output.dense")

    def _linear(self, x: Tensor, name: str) -> Tensor:
        return F.linear(x, self._weights[f"{name}.weight"], self._weights[f"{name}.bias"])

    def _norm(self, x: Tensor, name: str) -> Tensor:
        weight, bias = self._weights[f"{name}.weight"], self._weights[f"{name}.bias"]
        return F.layer_norm(x, x.shape[-1:], weight, bias, _EPS)
