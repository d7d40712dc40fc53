"""What the denoiser asks of a text encoder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import torch


@dataclass(frozen=True)
class TokenStates:
    """Contextual token states of a batch of sentences.

    Attributes:
        states: [N, L, D] float32; rows past a sentence's end are zero.
        mask: [N, L] bool, true on tokens.
    """

    states: torch.Tensor
    mask: torch.Tensor

    def pooled(self) -> torch.Tensor:
        """Return the unit vector of each sentence's mean state [N, D]."""
        mean = self.states.sum(1) / self.mask.sum(1, keepdim=True)
        return torch.nn.functional.normalize(mean, dim=-1)


class TextEncoder(Protocol):
    """A frozen language model that gives a state per token.

    Token states rather than one vector per sentence: pooled vectors hide left from right.

    Attributes:
        name: As in `TEXT_ENCODERS`.
        dim: Width D of the states.
        sha256: Hash of the model file; a checkpoint refuses another encoder than its own.
    """

    name: str
    dim: int
    sha256: str

    def encode(self, texts: Sequence[str]) -> TokenStates:
        """Return the token states of sentences; "" is the unconditional text."""
        ...


def sort_out_padding(states: torch.Tensor, mask: torch.Tensor) -> TokenStates:
    """Zero the states of padding, so that they cannot leak into sums."""
    keep = mask.bool()
    return TokenStates(states.float() * keep[..., None], keep)
