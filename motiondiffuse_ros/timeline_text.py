"""Timelines for people who type: `[0-4] a person walks | [4-7] turns left | right_arm[5-7]: waves`.

Pieces are separated by `|`. Each has its time in brackets, in seconds, before it the parts that do
it, if not the whole body does (several with `+`), and behind it the text, with or without a colon.
"""

from __future__ import annotations

import re

from motiondiffuse_ros.errors import RequestError

_NUMBER = r"(\d+(?:\.\d*)?|\.\d+)"
# no piece of text can be divided among the parts of these in more than one way: texts come from
# anybody, and patterns that try every division take hours for long ones
_PIECE = re.compile(r"^(?P<parts>[^\[\]]*)\[(?P<span>[^\[\]]*)\]\s*:?(?P<text>.*)$", re.DOTALL)
_SPAN = re.compile(rf"^ ?{_NUMBER} ?s? ?[-–] ?{_NUMBER} ?s? ?$")
_TIMED = re.compile(r"\[[^\[\]\d]*\d[^\[\]]*\]")
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
        span = found and _SPAN.match(" ".join(found["span"].split()))
        if not found or not span:
            raise RequestError(
                f"piece {i} of the text, {piece.strip()!r}, is not a timed text; write: {FORM}"
            )
        parts = tuple(name for name in re.split(r"[\s+,]+", found["parts"].strip()) if name)
        pieces.append((found["text"].strip(), float(span[1]), float(span[2]), parts))
    return pieces
