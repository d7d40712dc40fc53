"""The body parts that a request can address, each a set of joints of the canonical skeleton."""

from __future__ import annotations

from motiondiffuse_ros.motion.skeleton import CANONICAL

PARTS: dict[str, tuple[str, ...]] = {
    "left_arm": ("left_collar", "left_shoulder", "left_elbow", "left_wrist"),
    "right_arm": ("right_collar", "right_shoulder", "right_elbow", "right_wrist"),
    "torso": ("spine1", "spine2", "spine3"),
    "head": ("neck", "head"),
    "legs": (
        *("pelvis", "left_hip", "right_hip", "left_knee", "right_knee"),
        *("left_ankle", "right_ankle", "left_foot", "right_foot"),
    ),
}
"""Parts in the order of the request file; `legs` carries the root. Together every joint once."""


def part_joints(part: str) -> tuple[int, ...]:
    """Return the canonical joint indices of a part.

    Raises:
        KeyError: If there is no such part; the message lists the names.
    """
    if part not in PARTS:
        raise KeyError(f"unknown body part '{part}'; the parts are {', '.join(PARTS)}")
    return tuple(CANONICAL.index(name) for name in PARTS[part])
