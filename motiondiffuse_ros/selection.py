"""The choice among candidates: what was asked for first, then what a body can do.

Plausibility alone prefers whoever does least: the candidate that stands still breaks no law of
physics. So only candidates that match the texts about as well as the best one are compared.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.evaluation.evaluator import Evaluator
from motiondiffuse_ros.motion.rotations import Array

MATCH_MARGIN = 0.05
"""Candidates whose match is less than this below the best one's are as good as it."""

_MIN_FRAMES = 20
_SAME = 0.9  # a statement this near to the text says the same


class TextMatch:
    """How well candidates do what whole-body texts ask for.

    A match is by how much a motion is nearer to its text, in cosine, than to any statement that
    says something else (`corpus.statements`): a body that stands still is near to every quiet text,
    but nearest to "stands still".
    """

    def __init__(self, critic: Evaluator, texts: Sequence[TimedText]) -> None:
        """Take what is asked for.

        Args:
            critic: Trained on the representation of the candidates.
            texts: Of the request; those on parts, of less than a second or empty are not judged.
        """
        self._critic = critic
        self._judged = [
            t for t in texts if not t.parts and t.stop - t.start >= _MIN_FRAMES and t.text
        ]
        if self._judged:
            self._text = critic.embed_texts([t.text for t in self._judged])
            self._same = self._text @ critic.statements.T > _SAME

    def __call__(self, candidates: Sequence[Array]) -> list[float | None]:
        """Return the match of each candidate, -2 to 2; None for all if no text can be judged.

        Args:
            candidates: Features [T, D], not normalised, at the frame rate of the texts.

        Returns:
            The mean over texts weighted by their duration.
        """
        if not self._judged:
            return [None] * len(candidates)
        pieces = [features[t.start : t.stop] for features in candidates for t in self._judged]
        embedded = self._critic.embed_motions(pieces)
        embedded = embedded.reshape(len(candidates), len(self._judged), -1)
        others = embedded @ self._critic.statements.T
        lead = (embedded * self._text).sum(axis=-1) - np.where(self._same, -1.0, others).max(-1)
        frames = np.array([t.stop - t.start for t in self._judged], dtype=float)
        return [float(row @ frames / frames.sum()) for row in lead]


def eligible(matches: Mapping[int, float | None]) -> list[int]:
    """Return the candidates that match well enough to be chosen, the best first.

    Args:
        matches: Of `TextMatch`, by candidate.
    """
    least = max((m for m in matches.values() if m is not None), default=0.0) - MATCH_MARGIN
    lead = {i: math.inf if m is None else m for i, m in matches.items()}
    return sorted((i for i in lead if lead[i] >= least), key=lambda i: -lead[i])


def leading(matches: Sequence[float | None], count: int) -> list[int]:
    """Return the indices of the best candidates, rising; of all if none could be judged.

    Args:
        matches: Of `TextMatch`.
        count: How many at most.
    """
    known = {i: match for i, match in enumerate(matches) if match is not None}
    if not known:
        return list(range(len(matches)))
    return sorted(sorted(known, key=lambda i: -known[i])[:count])
