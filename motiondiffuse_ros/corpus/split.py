"""Train, validation and test by clip: a clip's own name decides, on every machine the same."""

from __future__ import annotations

import hashlib

SPLITS = ("train", "val", "test")
_VAL, _TEST = 0.05, 0.10


def split_of(dataset: str, clip: str) -> str:
    """Return the split of a clip.

    A clip's mirror image has no name of its own and so falls on the same side. About 85 % of
    names are train, 5 % val, 10 % test.
    """
    digest = hashlib.sha256(f"{dataset}/{clip}".encode()).digest()
    place = int.from_bytes(digest[:8], "big") / 2**64
    if place < _TEST:
        return "test"
    return "val" if place < _TEST + _VAL else "train"
