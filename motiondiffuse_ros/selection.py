"""The choice among candidates: what was asked for first, then what a body can do.

Plausibility alone prefers whoever does least: the candidate that stands still breaks no law of
physics. So only candidates that match the texts about as well as the best one are compared.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.evaluation.evaluator import Evaluator
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.features import Representation

MATCH_MARGIN = 0.05
"""Candidates whose match is less than this below the best one's are as good as it."""

_MIN_FRAMES = 20
_SAME = 0.9  # a statement this near to the text says the same


def text_matches(
    critic: Evaluator,
    representation: Representation,
    motions: Sequence[Motion],
    texts: Sequence[TimedText],
) -> list[float | None]:
    """Return how well each candidate does what whole-body texts ask for.

    Args:
        critic: Trained on `representation`.
        representation: Encodes the motions.
        motions: Candidates at the frame rate of `texts`.
        texts: Of the request; those on parts, of less than a second or empty are not judged.

    Returns:
        By how much the motion is nearer to its text, in cosine, than to any statement that says
        something else (`corpus.statements`): a body that stands still is near to every quiet
        text, but nearest to "stands still". The mean over texts weighted by their duration, -2 to
        2; None for all if no text can be judged.
    """
    judged = [t for t in texts if not t.parts and t.stop - t.start >= _MIN_FRAMES and t.text]
    if not judged:
        return [None] * len(motions)
    text = critic.embed_texts([t.text for t in judged])
    others = critic.statements
    same = text @ others.T > _SAME
    frames = np.array([t.stop - t.start for t in judged], dtype=float)
    pieces = [
        representation.encode(motion.slice(t.start, t.stop)) for motion in motions for t in judged
    ]
    embedded = critic.embed_motions(pieces).reshape(len(motions), len(judged), -1)
    nearest = np.where(same, -1.0, embedded @ others.T).max(axis=-1)
    lead = (embedded * text).sum(axis=-1) - nearest
    return [float(row @ frames / frames.sum()) for row in lead]


def eligible(matches: Sequence[float | None]) -> list[int]:
    """Return the indices of the candidates that match well enough to be chosen.

    Args:
        matches: `text_matches`.
    """
    known = [match for match in matches if match is not None]
    least = max(known) - MATCH_MARGIN if known else None
    return [i for i, m in enumerate(matches) if least is None or m is None or m >= least]
