"""The 263 numbers of HumanML3D."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.representations.guo import GuoFeatures, GuoSkeleton
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL, LEG_LENGTH

_SIDE, _UP, _AHEAD = (1, 0, 0), (0, 1, 0), (0, 0, 1)

# rest direction and length [m] of the bone that ends in each joint; all of HumanML3D is on one
# skeleton, and these are measured on its published sample 012314
_BONES = {
    "left_hip": (_SIDE, 0.10307),
    "right_hip": (_SIDE, 0.10988),
    "spine1": (_UP, 0.13157),
    "left_knee": (_UP, 0.39362),
    "right_knee": (_UP, 0.39019),
    "spine2": (_UP, 0.14319),
    "left_ankle": (_UP, 0.43243),
    "right_ankle": (_UP, 0.42564),
    "spine3": (_UP, 0.05736),
    "left_foot": (_AHEAD, 0.14338),
    "right_foot": (_AHEAD, 0.14942),
    "neck": (_UP, 0.21936),
    "left_collar": (_SIDE, 0.13749),
    "right_collar": (_SIDE, 0.14338),
    "head": (_AHEAD, 0.10304),
    "left_shoulder": (_UP, 0.13161),
    "right_shoulder": (_UP, 0.12298),
    "left_elbow": (_UP, 0.25684),
    "right_elbow": (_UP, 0.26309),
    "left_wrist": (_UP, 0.26601),
    "right_wrist": (_UP, 0.26988),
}
_LENGTHS = np.array([0.0] + [_BONES[name][1] for name in CANONICAL.names[1:]])
_HIPS = [CANONICAL.index("left_hip"), CANONICAL.index("right_hip")]
_LEGS = [CANONICAL.index(f"{s}_{j}") for s in ("left", "right") for j in ("knee", "ankle")]
_SCALE = float(_LENGTHS[_LEGS].sum() / 2.0 / LEG_LENGTH)


def _direction(name: str) -> tuple[int, int, int]:
    x, y, z = _BONES[name][0]
    downwards = name.endswith(("knee", "ankle", "shoulder", "elbow", "wrist"))
    return (-x if name.startswith("right") else x, -y if downwards else y, z)


_SKELETON = GuoSkeleton(
    chains=(
        (0, 2, 5, 8, 11),
        (0, 1, 4, 7, 10),
        (0, 3, 6, 9, 12, 15),
        (9, 14, 17, 19, 21),
        (9, 13, 16, 18, 20),
    ),
    directions=np.array([(0, 0, 0), *map(_direction, CANONICAL.names[1:])], dtype=float),
    owners=tuple(range(len(CANONICAL.names))),
    twins=CANONICAL.mirror_index,
    face=(2, 1, 17, 16),
    feet=(7, 10, 8, 11),
    still=0.002,
)


class HumanML3D(GuoFeatures):
    """HumanML3D's 263 numbers, m, at 20 fps, on its own skeleton of our 22 joints."""

    name = "humanml3d"

    def __init__(self) -> None:
        super().__init__(_SKELETON)

    def from_canonical(self, positions: Array) -> Array:
        """Return the joints on HumanML3D's skeleton [T, 22, 3]: its lengths, our directions."""
        out = np.zeros_like(positions)
        for j, parent in enumerate(CANONICAL.parents):
            if parent >= 0:
                bone = rot.unit(positions[:, j] - positions[:, parent])
                out[:, j] = out[:, parent] + _LENGTHS[j] * bone
        shift = positions[:, _HIPS].mean(axis=1) * _SCALE - out[:, _HIPS].mean(axis=1)
        return out + shift[:, None]

    def to_canonical(self, positions: Array) -> Array:
        """Return the positions as they are."""
        return positions
