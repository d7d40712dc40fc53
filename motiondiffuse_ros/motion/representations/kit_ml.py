"""The 251 numbers of KIT-ML as HumanML3D's authors processed it."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.representations.guo import GuoFeatures, GuoSkeleton
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL

UNITS_PER_METRE = 480 / 0.75
"""KIT-ML's unit of length, as TEMOS and MLD scale it; decoding does not depend on it."""

# The 21 joints by the side they are on when the body faces z, as the published features do. Some
# later code names the first arm and leg L, after the joints of the original motion model; the
# published facing direction makes them the right ones.
_NAMES = (
    *("pelvis", "spine1", "spine3", "neck", "head"),
    *(f"{side}_{joint}" for side in ("right", "left") for joint in ("shoulder", "elbow", "wrist")),
    *(
        f"{side}_{joint}"
        for side in ("right", "left")
        for joint in ("hip", "knee", "ankle", "instep", "foot")
    ),
)
_SWAP = {"left": "right", "right": "left"}


def _twin(name: str) -> int:
    side, _, joint = name.partition("_")
    return _NAMES.index(f"{_SWAP[side]}_{joint}" if side in _SWAP else name)


def _direction(name: str) -> tuple[int, int, int]:
    side, _, joint = name.partition("_")
    if joint in ("shoulder", "hip"):
        return (1 if side == "right" else -1, 0, 0)
    if joint in ("instep", "foot"):
        return (0, 0, 1)
    return (0, -1 if joint else 1, 0)


_SKELETON = GuoSkeleton(
    chains=(
        (0, 11, 12, 13, 14, 15),
        (0, 16, 17, 18, 19, 20),
        (0, 1, 2, 3, 4),
        (3, 5, 6, 7),
        (3, 8, 9, 10),
    ),
    directions=np.array([(0, 0, 0), *map(_direction, _NAMES[1:])], dtype=float),
    owners=tuple(CANONICAL.index(name.replace("instep", "foot")) for name in _NAMES),
    twins=tuple(map(_twin, _NAMES)),
    face=(11, 16, 5, 8),
    feet=(19, 20, 14, 15),
    still=0.05,
)


def _weights(name: str, among: tuple[str, ...]) -> Array:
    """Return the weights, with the sum one, that make a T-pose joint of others."""
    rest = CANONICAL.positions(np.zeros(3), rot.identity(len(CANONICAL.names)))
    rest = np.append(rest, np.ones((len(rest), 1)), axis=1)
    columns = rest[[CANONICAL.index(n) for n in among]].T
    return np.linalg.lstsq(columns, rest[CANONICAL.index(name)], rcond=None)[0]


_CHEST = ("spine3", "left_shoulder", "right_shoulder")
_MISSING = {
    "spine2": ("spine1", "spine3"),
    "left_collar": _CHEST,
    "right_collar": _CHEST,
}


class KitML(GuoFeatures):
    """KIT-ML's 251 numbers at 12.5 fps, on its own skeleton of 21 joints and in its own unit.

    Our spine2 and collars, which it has not, lie between its spine and shoulders as in the
    T-pose. Encoding writes our bone lengths in its unit.
    """

    name = "kit_ml"

    def __init__(self) -> None:
        super().__init__(_SKELETON)

    def from_canonical(self, positions: Array) -> Array:
        """Return KIT-ML's joints [T, 21, 3]; the instep is halfway from ankle to toes."""
        out = positions[:, list(_SKELETON.owners)]
        for side in _SWAP:
            ankle, instep, foot = (
                _NAMES.index(f"{side}_{joint}") for joint in ("ankle", "instep", "foot")
            )
            out[:, instep] = 0.5 * (out[:, ankle] + out[:, foot])
        return out * UNITS_PER_METRE

    def to_canonical(self, positions: Array) -> Array:
        """Return the 22 canonical joints [T, 22, 3]."""
        out = np.empty((len(positions), len(CANONICAL.names), 3))
        for name in CANONICAL.names:
            if name in _NAMES:
                out[:, CANONICAL.index(name)] = positions[:, _NAMES.index(name)]
        for name, among in _MISSING.items():
            sources = positions[:, [_NAMES.index(n) for n in among]]
            out[:, CANONICAL.index(name)] = np.einsum("tjk,j->tk", sources, _weights(name, among))
        return out
