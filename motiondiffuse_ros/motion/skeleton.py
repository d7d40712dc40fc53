"""The canonical skeleton: 22 joints in the order of SMPL and HumanML3D, bones of fixed length."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A kinematic tree whose zero rotation is the T-pose.

    Attributes:
        names: Joint names, parents before children; the first is the root.
        parents: Index of each joint's parent, -1 for the root.
        offsets: Position of each joint in its parent's frame [J, 3], m; x forward, y left, z up.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array = field(repr=False)

    def index(self, name: str) -> int:
        """Return the index of a joint.

        Raises:
            KeyError: If there is no such joint; the message lists the names.
        """
        if name not in self.names:
            raise KeyError(f"unknown joint '{name}'; the joints are {', '.join(self.names)}")
        return self.names.index(name)

    @cached_property
    def mirror_index(self) -> tuple[int, ...]:
        """For each joint the joint on the other side of the body (itself in the middle)."""
        swap = {"left_": "right_", "right_": "left_"}
        return tuple(
            self.names.index(
                next((swap[s] + n.removeprefix(s) for s in swap if n.startswith(s)), n)
            )
            for n in self.names
        )

    def global_rotations(self, rotations: Array) -> Array:
        """Chain local rotations [..., J, 4] into world rotations [..., J, 4]."""
        out = np.empty_like(rotations)
        for j, p in enumerate(self.parents):
            local = rotations[..., j, :]
            out[..., j, :] = local if p < 0 else rot.multiply(out[..., p, :], local)
        return out

    def local_rotations(self, global_rotations: Array) -> Array:
        """Undo `global_rotations`."""
        out = np.array(global_rotations)
        for j, p in enumerate(self.parents):
            if p >= 0:
                out[..., j, :] = rot.multiply(
                    rot.conjugate(global_rotations[..., p, :]), global_rotations[..., j, :]
                )
        return out

    def positions(self, root: Array, global_rotations: Array) -> Array:
        """Forward kinematics.

        Args:
            root: Root positions [..., 3], m.
            global_rotations: World rotations [..., J, 4].

        Returns:
            World positions [..., J, 3], m.
        """
        out = np.empty((*global_rotations.shape[:-1], 3))
        for j, p in enumerate(self.parents):
            if p < 0:
                out[..., j, :] = root
            else:
                bone = rot.rotate(global_rotations[..., p, :], self.offsets[j])
                out[..., j, :] = out[..., p, :] + bone
        return out


# name, parent, offset from the parent in the T-pose [m]; a person of about 1.72 m with straight,
# upright limbs, so that zero rotation means the same on every robot and in every data set
_CANONICAL = (
    ("pelvis", None, (0.0, 0.0, 0.0)),
    ("left_hip", "pelvis", (0.0, 0.09, -0.07)),
    ("right_hip", "pelvis", (0.0, -0.09, -0.07)),
    ("spine1", "pelvis", (-0.02, 0.0, 0.11)),
    ("left_knee", "left_hip", (0.0, 0.0, -0.40)),
    ("right_knee", "right_hip", (0.0, 0.0, -0.40)),
    ("spine2", "spine1", (0.0, 0.0, 0.13)),
    ("left_ankle", "left_knee", (0.0, 0.0, -0.41)),
    ("right_ankle", "right_knee", (0.0, 0.0, -0.41)),
    ("spine3", "spine2", (0.01, 0.0, 0.06)),
    ("left_foot", "left_ankle", (0.13, 0.0, -0.06)),
    ("right_foot", "right_ankle", (0.13, 0.0, -0.06)),
    ("neck", "spine3", (-0.01, 0.0, 0.21)),
    ("left_collar", "spine3", (0.0, 0.07, 0.12)),
    ("right_collar", "spine3", (0.0, -0.07, 0.12)),
    ("head", "neck", (0.03, 0.0, 0.10)),
    ("left_shoulder", "left_collar", (0.0, 0.11, 0.02)),
    ("right_shoulder", "right_collar", (0.0, -0.11, 0.02)),
    ("left_elbow", "left_shoulder", (0.0, 0.27, 0.0)),
    ("right_elbow", "right_shoulder", (0.0, -0.27, 0.0)),
    ("left_wrist", "left_elbow", (0.0, 0.25, 0.0)),
    ("right_wrist", "right_elbow", (0.0, -0.25, 0.0)),
)


def _canonical() -> Skeleton:
    names = tuple(name for name, _, _ in _CANONICAL)
    parents = tuple(-1 if parent is None else names.index(parent) for _, parent, _ in _CANONICAL)
    return Skeleton(names, parents, np.array([offset for _, _, offset in _CANONICAL]))


CANONICAL = _canonical()

SIDES = ("left", "right")
"""What names of paired joints begin with."""

# Height of the joint above the sole when the foot stands flat [m].
ANKLE_HEIGHT = 0.08
TOE_HEIGHT = 0.02

HEEL_BEHIND_ANKLE = 0.06
"""The sole's rear edge behind the ankle [m]."""

LEG_LENGTH = 0.81
"""Hip to ankle along the bones [m]: what a root translation is scaled by at import."""

STANDING_HEIGHT = 0.07 + LEG_LENGTH + ANKLE_HEIGHT
"""Height of the pelvis in the T-pose above the floor [m]."""
