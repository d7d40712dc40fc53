"""The side of a sideways walk, from the kinematics of the window that is shown.

Many captions say that somebody walks sideways without saying to which side, and a clip may hold
both. Where a window leaves no doubt the side is added, so that "left" and "right" are learnt.
"""

from __future__ import annotations

import re

from motiondiffuse_ros.corpus.travel import Travel
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.rotations import Array

_SIDEWAYS = re.compile(r"\b(sideways?|side ?-?steps?|to the side|lateral)\b", re.IGNORECASE)
_SIDE = re.compile(r"\b(left|right|side to side|both)", re.IGNORECASE)


def name_side(text: str, features: Array, representation: Representation, fps: float) -> str:
    """Return the caption with "to the left" or "to the right" added if that is certain.

    Args:
        text: A caption.
        features: Of the window [T, D], not normalised.
        representation: What they mean; without root velocities no side is certain.
        fps: Their rate, Hz.
    """
    forms = forms_of(text)
    if len(forms) == 1 or "root_velocity" not in representation.groups():
        return text
    side = Travel.of(features, representation, fps).side
    return forms[0] if side == 0 else forms[1 if side > 0 else 2]


def forms_of(text: str) -> tuple[str, ...]:
    """Return a caption, and for one that leaves the side open its form to the left and right."""
    if not _SIDEWAYS.search(text) or _SIDE.search(text):
        return (text,)
    return text, f"{text} to the left", f"{text} to the right"
