"""Token states of every caption of a corpus, computed once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import torch

from motiondiffuse_ros.corpus.captions import mirror_caption
from motiondiffuse_ros.corpus.sideways import forms_of
from motiondiffuse_ros.corpus.store import Clip
from motiondiffuse_ros.corpus.wordings import wordings_of_clip
from motiondiffuse_ros.evaluation.actions import action_of
from motiondiffuse_ros.text import TextEncoder, TokenStates

_BATCH = 256


class CaptionStates:
    """A table from sentence to token states, held in half precision."""

    def __init__(
        self,
        texts: Iterable[str],
        encoder: TextEncoder,
        on_progress: Callable[[int, int], None] | None = None,
    ) -> None:
        # by length, so that batches have little padding
        ordered = sorted(set(texts), key=lambda text: (len(text), text))
        self._states: dict[str, torch.Tensor] = {}
        for start in range(0, len(ordered), _BATCH):
            batch = ordered[start : start + _BATCH]
            tokens = encoder.encode(batch)
            for text, states, mask in zip(batch, tokens.states, tokens.mask, strict=True):
                self._states[text] = states[mask].half().clone()
            if on_progress is not None:
                on_progress(min(start + _BATCH, len(ordered)), len(ordered))

    def batch(self, texts: Sequence[str]) -> TokenStates:
        """Return the padded states of sentences of the table."""
        rows = [self._states[text] for text in texts]
        states = torch.nn.utils.rnn.pad_sequence([r.float() for r in rows], batch_first=True)
        lengths = torch.tensor([len(r) for r in rows])
        return TokenStates(states, torch.arange(states.shape[1])[None] < lengths[:, None])


def texts_of(clip: Clip) -> tuple[str, ...]:
    """Return what is said of a clip: its captions and, if it has one, its action label."""
    return *clip.captions, *named_deeds(clip)[1:]


def other_words_of(clip: Clip) -> tuple[str, ...]:
    """Return other words for what is done in a clip."""
    return wordings_of_clip(clip.name, named_deeds(clip))


def named_deeds(clip: Clip) -> tuple[str, ...]:
    """Return what names the deed of a clip: its first caption and, if it has one, its label."""
    label = action_of(clip)
    return clip.captions[:1] if label is None else (*clip.captions[:1], label)


def all_captions(clips: Iterable[Clip], statements: Iterable[str]) -> set[str]:
    """Return every text that training may show.

    Captions, action labels and other words, with their sides, statements, the mirror images of all
    and the empty text.

    Args:
        clips: That are shown.
        statements: That may be drawn (`WindowSampler.stated_texts`).
    """
    said = (text for clip in clips for text in (*texts_of(clip), *other_words_of(clip)))
    texts = {form for text in said for form in forms_of(text)}
    texts |= set(statements)
    return texts | {mirror_caption(text) for text in texts} | {""}
