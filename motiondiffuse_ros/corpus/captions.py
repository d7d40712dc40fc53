"""Captions: reading caption files, and the mirror image of a sentence."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path

from motiondiffuse_ros.errors import CorpusError

_MIRROR = {
    "left": "right",
    "lefts": "rights",
    "leftward": "rightward",
    "leftwards": "rightwards",
    "left-handed": "right-handed",
    "clockwise": "counterclockwise",
    "anticlockwise": "clockwise",
    "counter-clockwise": "clockwise",
    "anti-clockwise": "clockwise",
}
_MIRROR |= {b: a for a, b in _MIRROR.items() if b not in _MIRROR}
_MIRROR_PATTERN = re.compile(
    r"(?<![\w-])(" + "|".join(sorted(map(re.escape, _MIRROR), key=len, reverse=True)) + r")(?!\w)",
    re.IGNORECASE,
)
# "right" that is not a side
_NOT_A_SIDE = re.compile(r"\b(right (?:away|angles?|now)|all right)\b", re.IGNORECASE)


def mirror_caption(text: str) -> str:
    """Swap left and right (and the senses of rotation) in a sentence; case is kept."""
    held: list[str] = []

    def hold(match: re.Match[str]) -> str:
        held.append(match.group())
        return f"\0{len(held) - 1}\0"

    def swap(match: re.Match[str]) -> str:
        word = match.group()
        other = _MIRROR[word.lower()]
        return other.upper() if word.isupper() else other.title() if word[0].isupper() else other

    swapped = _MIRROR_PATTERN.sub(swap, _NOT_A_SIDE.sub(hold, text))
    return re.sub(r"\0(\d+)\0", lambda m: held[int(m.group(1))], swapped)


def shipped_caption_files() -> tuple[Path, ...]:
    """Return the caption files that come with the package."""
    folder = files("motiondiffuse_ros.corpus") / "captions"
    return tuple(sorted(Path(str(f)) for f in folder.iterdir() if f.name.endswith(".jsonl")))


def read_captions(paths: Iterable[Path]) -> dict[str, tuple[str, ...]]:
    """Read caption files: JSON lines with `captions` and either `clip` or `key`.

    Returns:
        Captions by clip name (file name without suffix) or by key (clip name without its last
        `_NNN`).

    Raises:
        CorpusError: If a file is missing or a line is not as described; names file and line.
    """
    captions: dict[str, tuple[str, ...]] = {}
    for path in paths:
        try:
            lines = Path(path).read_text(encoding="utf-8").splitlines()
        except OSError as error:
            raise CorpusError(f"caption file {path}: cannot be read ({error.strerror})") from error
        for number, line in enumerate(lines, start=1):
            try:
                entry = json.loads(line)
                name = entry.get("clip") or entry["key"]
                captions[name] = tuple(str(c).strip() for c in entry["captions"] if str(c).strip())
            except (ValueError, KeyError, TypeError, AttributeError) as error:
                raise CorpusError(
                    f"caption file {path}, line {number}: needs JSON with 'captions' and "
                    f"'clip' or 'key' ({error})"
                ) from error
    return captions


def captions_of(clip: str, captions: dict[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Return the captions of a clip, by its own name or by its key; empty if there are none."""
    return captions.get(clip) or captions.get(clip.rpartition("_")[0]) or ()
