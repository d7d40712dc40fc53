"""Joint positions: what the paper feeds on for HumanAct12 (as Action2Motion and ACTOR)."""

from __future__ import annotations

from motiondiffuse_ros.motion.frames import vectors_to_y_up, vectors_to_z_up
from motiondiffuse_ros.motion.from_positions import motion_from_positions
from motiondiffuse_ros.motion.layout import ROOT, VECTOR, Block, Layout
from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL


class JointPositions(Layout):
    """Positions of the 22 joints in the world, m.

    Blocks of the 66 numbers, y up, z ahead at the first frame, the first pelvis over the origin:
        root_position 3, positions 21 x 3.
    The originals have 24 joints (the last two are hands, which we have not) and put the first
    pelvis at the origin also in height; we keep the height, by which the floor is known.
    """

    name = "joint_positions"

    def __init__(self) -> None:
        joints = tuple(range(1, len(CANONICAL.names)))
        super().__init__(Block("root_position", ROOT, VECTOR), Block("positions", joints, VECTOR))

    def encode(self, motion: Motion) -> Array:
        """Return features [T, 66] of a motion."""
        positions = vectors_to_y_up(motion.canonicalised().positions)
        return self.join({"root_position": positions[:, 0], "positions": positions[:, 1:]})

    def decode(self, features: Array, fps: float) -> Motion:
        """Return the motion of features [T, 66]; twist is lost, see `motion.from_positions`."""
        positions = features.astype(float).reshape(len(features), -1, 3)
        return motion_from_positions(vectors_to_z_up(positions), fps).canonicalised()
