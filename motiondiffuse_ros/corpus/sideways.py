"""The side of a sideways walk, from the kinematics of the window that is shown.

Many captions say that somebody walks sideways without saying to which side, and a clip may hold
both. Where a window leaves no doubt the side is added, so that "left" and "right" are learnt.
"""

from __future__ import annotations

import re

import numpy as np

from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.rotations import Array

_SIDEWAYS = re.compile(r"\b(sideways?|side ?-?steps?|to the side|lateral)\b", re.IGNORECASE)
_SIDE = re.compile(r"\b(left|right|side to side|both)", re.IGNORECASE)
_MIN_DISTANCE = 0.4
_MIN_RATIO = 2.0


def name_side(text: str, features: Array, representation: Representation, fps: float) -> str:
    """Return the caption with "to the left" or "to the right" added if that is certain.

    Args:
        text: A caption.
        features: Of the window [T, D], not normalised.
        representation: What they mean; must have root velocities.
        fps: Their rate, Hz.
    """
    forms = forms_of(text)
    if len(forms) == 1:
        return text
    velocity = features[:, representation.groups()["root_velocity"]]  # x is left, z ahead
    left, ahead = velocity.sum(axis=0) / fps
    wandering = np.abs(velocity[:, 0]).sum() / fps
    certain = abs(left) > max(_MIN_DISTANCE, _MIN_RATIO * abs(ahead), 0.8 * wandering)
    return forms[1 if left > 0 else 2] if certain else text


def forms_of(text: str) -> tuple[str, ...]:
    """Return a caption, and for one that leaves the side open its form to the left and right."""
    if not _SIDEWAYS.search(text) or _SIDE.search(text):
        return (text,)
    return text, f"{text} to the left", f"{text} to the right"
