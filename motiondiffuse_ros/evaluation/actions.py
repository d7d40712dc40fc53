"""Actions: labels of the clips of an action data set, and the words they are asked for with."""

from __future__ import annotations

import re
from collections.abc import Sequence

from motiondiffuse_ros.corpus.captions import mirror_caption
from motiondiffuse_ros.corpus.store import Clip

_BANDAI_NAMCO = re.compile(r"dataset-\d+_(?P<content>.+)_[^_]+_\d+")


def action_of(clip: Clip) -> str | None:
    """Return the label of a clip in words ("walk turn left"), or None if it has none.

    Bandai-Namco names its clips dataset-D_CONTENT_STYLE_NNN; the content is the action.
    """
    match = _BANDAI_NAMCO.fullmatch(clip.name)
    return match["content"].replace("-", " ") if match else None


def actions_of(clips: Sequence[Clip]) -> tuple[str, ...]:
    """Return every label of some clips, and those of their mirror images, in order."""
    labels = {label for clip in clips if (label := action_of(clip)) is not None}
    return tuple(sorted(labels | {mirror_caption(label) for label in labels}))
