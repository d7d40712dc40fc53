"""Attention of the Cross-Modality Linear Transformer."""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional as F

_MASKED = -1e4  # finite in bf16; softmax makes it zero


class AttentionContext:
    """What attention needs of the attended sequence; for text it does not depend on the step."""

    __slots__ = ("keys", "mask", "values")

    def __init__(self, keys: Tensor | None, values: Tensor, mask: Tensor | None) -> None:
        self.keys, self.values, self.mask = keys, values, mask

    def to(self, dtype: torch.dtype) -> AttentionContext:
        """Return it with keys and values of another type."""
        keys = None if self.keys is None else self.keys.to(dtype)
        return AttentionContext(keys, self.values.to(dtype), self.mask)

    def expand(self, index: Tensor | slice) -> AttentionContext:
        """Select rows of the batch."""
        return AttentionContext(
            None if self.keys is None else self.keys[index],
            self.values[index],
            None if self.mask is None else self.mask[index],
        )

    def beside(self, other: AttentionContext) -> AttentionContext:
        """Return these rows of the batch, then those of another; a shorter one is padded."""
        keys = mask = None
        if self.keys is not None and other.keys is not None:
            keys = _joined(self.keys, other.keys, axis=2)
        if self.mask is not None and other.mask is not None:
            mask = _joined(self.mask, other.mask, axis=1)
        return AttentionContext(keys, _joined(self.values, other.values, axis=2), mask)


def _joined(one: Tensor, other: Tensor, axis: int) -> Tensor:
    """Return both batches in one, with zeros after the end of the shorter one along an axis."""
    length = max(one.shape[axis], other.shape[axis])
    after = (0, 0) * (one.ndim - 1 - axis)
    return torch.cat([F.pad(x, (*after, 0, length - x.shape[axis])) for x in (one, other)])


class Attention(nn.Module):
    """Multi-head attention with its normalisation, in the efficient or the full form.

    The efficient form (Shen et al. 2021, eq. 8 of the paper) takes the softmax of the queries over
    channels and of the keys over the sequence, so that a [d, d] summary of the sequence is all that
    the queries meet: cost linear in length.
    """

    def __init__(self, width: int, context_width: int, heads: int, kind: str) -> None:
        super().__init__()
        self.heads, self.kind = heads, kind
        self.norm = nn.LayerNorm(width)
        self.context_norm = nn.LayerNorm(context_width)
        self.query = nn.Linear(width, width)
        self.key = nn.Linear(context_width, width)
        self.value = nn.Linear(context_width, width)

    def context(self, x: Tensor, mask: Tensor) -> AttentionContext:
        """Summarise a sequence x [B, L, C] with mask [B, L] (true on tokens)."""
        x = self.context_norm(x)
        return self.summary(self.key(x), self.value(x), mask)

    def summary(self, keys: Tensor, values: Tensor, mask: Tensor | None) -> AttentionContext:
        """Summarise keys and values [B, L, width] with mask [B, L]; without one all count."""
        if self.kind == "full":
            return AttentionContext(self._split(keys), self._split(values), mask)
        if mask is not None:
            keys = keys.masked_fill(~mask[..., None], _MASKED)
        keys = keys.softmax(dim=1)
        return AttentionContext(None, self._split(keys).transpose(2, 3) @ self._split(values), None)

    def forward(self, x: Tensor, context: AttentionContext) -> Tensor:
        """Return what x [B, N, width] reads from a context, [B, N, width]."""
        return self.read(self.query(self.norm(x)), context)

    def read(self, queries: Tensor, context: AttentionContext) -> Tensor:
        """Return what queries [B, N, width] read from a context, [B, N, width]."""
        if context.keys is None:
            queries = queries.unflatten(-1, (self.heads, -1))
            # of bfloat16 the softmax itself takes twice as long, for the same result
            queries = queries.softmax(dim=-1, dtype=torch.float32).to(context.values.dtype)
            y = queries.transpose(1, 2) @ context.values
        else:
            mask = None if context.mask is None else context.mask[:, None, None, :]
            queries = self._split(queries)
            y = F.scaled_dot_product_attention(queries, context.keys, context.values, mask)
        return y.transpose(1, 2).flatten(2)

    def _split(self, x: Tensor) -> Tensor:
        return x.unflatten(-1, (self.heads, -1)).transpose(1, 2)


def pad_mask(lengths: Tensor, size: int) -> Tensor:
    """Return [B, size] bool, true on the first `lengths` positions."""
    return torch.arange(size, device=lengths.device)[None] < lengths[:, None]
