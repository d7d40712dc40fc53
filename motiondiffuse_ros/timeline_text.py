"""Timelines for people who type: `[0-4] a person walks | [4-7] turns left | right_arm[5-7]: waves`.

Pieces are separated by `|`. Each has its time in brackets, in seconds, before it the parts that do
it, if not the whole body does (several with `+`), and behind it the text, with or without a colon.
"""

from __future__ import annotations

import re

from motiondiffuse_ros.errors import RequestError

_NUMBER = r"(\d+(?:\.\d*)?|\.\d+)"
_PIECE = re.compile(
    rf"^\s*(?P<parts>[^\[\]]*)\[\s*(?P<start>{_NUMBER})\s*s?\s*[-–]\s*(?P<end>{_NUMBER})\s*s?\s*\]"
    r"\s*:?(?P<text>.*)$",
    re.DOTALL,
)
_TIMED = re.compile(r"\[[^\]]*\d[^\]]*\]")
FORM = "[0-4] a person walks forward | right_arm[2-4]: waves"
"""How it looks, for messages."""

Piece = tuple[str, float, float, tuple[str, ...]]


def parse_timeline(text: str) -> list[Piece] | None:
    """Return (text, start, end, parts) of each piece, times in s; None for a text without times.

    Whether times and parts make sense is for `MotionRequest.validate` to say.

    Raises:
        RequestError: If some pieces have times and one has none, or one cannot be read.
    """
    if not _TIMED.search(text):
        return None
    pieces = []
    for i, piece in enumerate(text.split("|"), start=1):
        found = _PIECE.match(piece)
        if found is None:
            raise RequestError(
                f"piece {i} of the text, {piece.strip()!r}, is not a timed text; write: {FORM}"
            )
        parts = tuple(name for name in re.split(r"[\s+,]+", found["parts"].strip()) if name)
        pieces.append((found["text"].strip(), float(found["start"]), float(found["end"]), parts))
    return pieces
