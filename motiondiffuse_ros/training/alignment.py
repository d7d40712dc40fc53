"""Text alignment: the denoiser's pooled text learns to tell apart what motions tell apart.

The denoising loss teaches the text layers little about words that change one token and half a
body: "left" and "right" stay close together for hours. A critic's contrastive loss separates
them within minutes, so its text space is the target of a fixed part of the pooled text.
"""

from __future__ import annotations

from collections.abc import Iterable

import torch
from torch import Tensor

from motiondiffuse_ros.evaluation.evaluator import Evaluator

_SCALE = 15.0
_SEED = 0


class TextAlignment:
    """Distance between the pooled text and the critic's embedding of the same text."""

    def __init__(self, critic: Evaluator, texts: Iterable[str], time_width: int) -> None:
        """Embed every text once.

        Args:
            critic: Trained on the same training split.
            texts: All that training may show; "" keeps its freedom.
            time_width: Width of the pooled text.
        """
        ordered = sorted(set(texts) - {""})
        vectors = torch.from_numpy(critic.embed_texts(ordered))
        self._targets = dict(zip(ordered, vectors.clone(), strict=True))
        generator = torch.Generator().manual_seed(_SEED)
        # fixed directions: a learnt projection could read small differences and leave them small
        gaussian = torch.randn(time_width, vectors.shape[1], generator=generator)
        self._directions = torch.linalg.qr(gaussian).Q

    def __call__(self, pooled: Tensor, texts: list[str]) -> Tensor:
        """Return the mean squared distance, in the critic's unit, over texts that are not empty.

        Args:
            pooled: Of the denoiser's conditioning [B, time_width].
            texts: B sentences.
        """
        rows = [i for i, text in enumerate(texts) if text]
        if not rows:
            return pooled.sum() * 0.0
        target = torch.stack([self._targets[texts[i]] for i in rows])
        got = pooled[rows].float() @ self._directions / _SCALE
        return (got - target).square().sum(-1).mean()
