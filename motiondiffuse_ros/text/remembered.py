"""A text encoder that need not encode the same sentences twice in a row."""

from __future__ import annotations

from collections.abc import Sequence

from motiondiffuse_ros.text.encoder import TextEncoder, TokenStates


class Remembered:
    """A frozen encoder with its last answer: sampler and critic ask for the same sentences.

    More than the last is not kept, and an answer is always that of one call: what a sentence is
    batched with decides its last bits, and those must not depend on what was asked before.
    """

    def __init__(self, encoder: TextEncoder) -> None:
        """Wrap an encoder."""
        self.name, self.dim, self.sha256 = encoder.name, encoder.dim, encoder.sha256
        self._encoder = encoder
        self._last: tuple[tuple[str, ...], TokenStates] | None = None

    def encode(self, texts: Sequence[str]) -> TokenStates:
        """Return the token states of sentences; not to be changed."""
        asked = tuple(texts)
        last = self._last
        if last is None or last[0] != asked:
            last = self._last = asked, self._encoder.encode(asked)
        return last[1]
