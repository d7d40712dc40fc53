"""What of an existing motion is kept, as a request gives it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.fields import check_fields, names, number, rows, shown
from motiondiffuse_ros.motion.parts import PARTS

Span = tuple[float, float]

MOST_SPANS = 100
"""Most spans of an edit."""


@dataclass(frozen=True)
class Edit:
    """An existing motion, of which a part is kept while the rest is made anew.

    With both `regenerate` and `keep`, the parts are made anew between the kept spans only.

    Attributes:
        motion: A motion.npz or a BVH file of a known skeleton; as long as the request.
        regenerate: Body parts made anew; the others are kept. Empty keeps none as a whole.
        keep: Spans of time in which everything is kept, (start, end) in s, in order.
    """

    motion: str
    regenerate: tuple[str, ...] = ()
    keep: tuple[Span, ...] = ()

    @classmethod
    def from_dict(cls, data: Any) -> Edit:
        """Build from the `edit` of a request file.

        Raises:
            RequestError: If a field is unknown, missing or of the wrong type.
        """
        check_fields(cls, data, "edit")
        motion = data.get("motion")
        if not isinstance(motion, str):
            raise RequestError(f"edit: 'motion' must be the name of a file, got {shown(motion)}")
        spans = []
        for i, row in enumerate(rows(data.get("keep"), "edit: 'keep'", "[start, end]"), start=1):
            if not isinstance(row, (list, tuple)) or len(row) != 2:
                raise RequestError(
                    f"edit: span {i} of 'keep' must be [start, end], got {shown(row)}"
                )
            start, end = (number(value, f"edit: span {i} of 'keep'") for value in row)
            spans.append((start, end))
        return cls(motion, names(data.get("regenerate"), "edit: 'regenerate'"), tuple(spans))

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types; `from_dict` takes them back."""
        return {
            "motion": self.motion,
            "regenerate": list(self.regenerate),
            "keep": [list(span) for span in self.keep],
        }

    def validate(self, duration: float) -> None:
        """Refuse what cannot be honoured; does not read the file.

        Args:
            duration: Of the motion, s.

        Raises:
            RequestError: One line.
        """
        if not self.motion:
            raise RequestError("edit: no file; name a motion.npz or a BVH file")
        if not self.regenerate and not self.keep:
            raise RequestError(
                "edit: keeps nothing; say which parts to regenerate or spans to keep"
            )
        if len(self.keep) > MOST_SPANS:
            raise RequestError(f"edit: {len(self.keep)} spans to keep, at most {MOST_SPANS}")
        for part in self.regenerate:
            if part not in PARTS:
                raise RequestError(
                    f"edit: unknown body part '{part}'; the parts are {', '.join(PARTS)}"
                )
        if len(set(self.regenerate)) < len(self.regenerate):
            raise RequestError(f"edit: a body part is named twice: {', '.join(self.regenerate)}")
        _validate_spans(self.keep, duration)


def parse_spans(text: str) -> tuple[Span, ...]:
    """Read spans as people type them, `0-1.5,4-6`, in s.

    Raises:
        RequestError: If one cannot be read.
    """
    spans = []
    for piece in text.split(","):
        ends = piece.replace("–", "-").split("-")
        try:
            start, end = (float(value) for value in ends)
        except ValueError as error:
            raise RequestError(f"{piece.strip()!r} is not a span; write: 0-1.5,4-6") from error
        spans.append((start, end))
    return tuple(spans)


def _validate_spans(spans: Sequence[Span], duration: float) -> None:
    before = 0.0
    for i, (start, end) in enumerate(spans, start=1):
        if not (math.isfinite(start) and math.isfinite(end)) or start < 0.0 or end <= start:
            raise RequestError(
                f"edit: span {i} to keep, {start:g} to {end:g} s, must be finite and end after "
                "its start"
            )
        if end > duration + 1e-9:
            raise RequestError(
                f"edit: span {i} to keep ends at {end:g} s, after the motion's {duration:g} s"
            )
        if start < before:
            raise RequestError(
                f"edit: span {i} to keep starts at {start:g} s, before the end of span {i - 1}"
            )
        before = end
