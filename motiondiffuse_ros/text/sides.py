"""The side that a text leaves open, said: circles go one way round.

Of a circle without a side the denoiser predicts, from almost nothing but noise, the average of left
and right, and so goes straight (docs/training.md).
"""

from __future__ import annotations

import re

_SIDE = "to the left"
"""Towards positive yaw (REP-103). Always the same, so that a motion that goes on with the same text
goes on the same way round."""

_CIRCLING = r"circl(?:e|es|ing)\s+(?:a?round|about)"
_CIRCLE = re.compile(
    r"\b(?:(?:in|around|round|along|a|one|two|three|several|some|the)\s+"
    r"(?:(?:a|the|full|whole|complete|small|little|tiny|big|large|huge|wide|tight|perfect)\s+){0,4}"
    r"(?:circles?|loops?|rings?|circular\s+(?:path|way|route|motion))|round\s+and\s+round|"
    rf"{_CIRCLING})\b",
    re.IGNORECASE,
)
_TRAVELS = re.compile(
    r"\b(?:walk|run|runn|jog|jogg|pac|stroll|march|wander|ambl|sneak|limp|tiptoe|skip|skipp|hop|"
    r"hopp|gallop|stagger|trot|trott|sprint|strut|shuffl|crawl|creep)(?:e|s|es|ing|ed)?\b|"
    rf"\b{_CIRCLING}\b",
    re.IGNORECASE,
)
_MOVES = re.compile(
    r"\b(?:go|goes|going|mov(?:e|es|ing)|step(?:s|ping)?|mak(?:e|es|ing)|do|does|doing)\b",
    re.IGNORECASE,
)
_LIMB = re.compile(
    r"\b(?:arm|forearm|hand|fist|finger|wrist|elbow|shoulder|head|neck|hip|waist|torso|pelvis|leg|"
    r"knee|foot|feet|ankle|heel|toe)s?\b",
    re.IGNORECASE,
)
_SIDED = re.compile(
    r"\b(?:left|right)(?:wards?|hand(?:ed)?)?\b|clockwise|widdershins", re.IGNORECASE
)
_NEXT = re.compile(r"\b(?:then|before|after|afterwards)\b|[;.!]", re.IGNORECASE)


def with_side(text: str) -> str:
    """Return a text in which a walk in a circle that has no side goes to the left.

    Everything else stays as it is, circles that are drawn by a limb among it.

    Args:
        text: What somebody typed, in English.
    """
    begins = 0
    pieces: list[str] = []
    for end in [*(m.start() for m in _NEXT.finditer(text)), len(text)]:
        pieces.append(_clause(text[begins:end]))
        begins = end
    return "".join(pieces)


def _clause(clause: str) -> str:
    circle = _CIRCLE.search(clause)
    if circle is None or _SIDED.search(clause):
        return clause
    whole_body = _TRAVELS.search(clause) or (_MOVES.search(clause) and not _LIMB.search(clause))
    if not whole_body:
        return clause
    return f"{clause[: circle.end()]} {_SIDE}{clause[circle.end() :]}"
