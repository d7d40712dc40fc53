"""Root translation and 6D rotations: what the paper feeds on for UESTC and BABEL."""

from __future__ import annotations

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.frames import (
    quaternions_to_y_up,
    quaternions_to_z_up,
    vectors_to_y_up,
    vectors_to_z_up,
)
from motiondiffuse_ros.motion.layout import COLUMNS, ROOT, VECTOR, Block, Layout
from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL


class RootRotations(Layout):
    """Root translation, m, and the rotation of each joint in its parent's frame.

    Blocks of the 135 numbers, y up, z ahead at the first frame, which is over the origin:
        root_position 3, rotations 22 x 6 (first two columns; the root's is in the world).
    ACTOR writes the first two rows, which are the columns of the inverse, and 24 joints.
    """

    name = "root_rotations"

    def __init__(self) -> None:
        joints = tuple(range(len(CANONICAL.names)))
        super().__init__(Block("root_position", ROOT, VECTOR), Block("rotations", joints, COLUMNS))

    def encode(self, motion: Motion) -> Array:
        """Return features [T, 135] of a motion."""
        motion = motion.canonicalised()
        columns = rot.to_columns(quaternions_to_y_up(motion.rotations))
        return self.join({"root_position": vectors_to_y_up(motion.root), "rotations": columns})

    def decode(self, features: Array, fps: float) -> Motion:
        """Return the motion of features [T, 135]."""
        f = self.split(features)
        rotations = quaternions_to_z_up(rot.from_columns(f["rotations"]))
        return Motion(vectors_to_z_up(f["root_position"]), rotations, fps).canonicalised()
