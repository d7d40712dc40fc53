"""The features of Guo et al. 2022 as published with HumanML3D and KIT-ML.

Section 4.1 of the paper. Rates are per frame, and the data hold what the published scripts did:

- `root_turn` is half the angle that the heading turns to the right (arcsin of a quaternion's y);
- the heading looks ahead of the shoulders and against the hips, whose sides one script swaps
  (github.com/EricGuo5513/HumanML3D, issue 131), smoothed over 20 frames; in the first frame it
  is z, so that the first turn jumps;
- rotations are shortest arcs from a rest direction to a bone, stored at the joint the bone ends
  in, relative to the bone before; bones that start at a limb are relative to the inverse of the
  heading. They follow from the positions and hold no twist, so decoding takes the positions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.ndimage import gaussian_filter1d

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.differences import forward_difference, integrate
from motiondiffuse_ros.motion.frames import vectors_to_y_up, vectors_to_z_up
from motiondiffuse_ros.motion.from_positions import motion_from_positions
from motiondiffuse_ros.motion.layout import (
    COLUMNS,
    ODD_SCALAR,
    PLANAR,
    ROOT,
    SCALAR,
    VECTOR,
    Block,
    Layout,
)
from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import TOE_HEIGHT

_UP = 1
_SMOOTHING = 20.0
_GROUND = np.array([1.0, 0.0, 1.0])
_TO_SOLE = np.array([0.0, 0.0, TOE_HEIGHT])


@dataclass(frozen=True, eq=False)
class GuoSkeleton:
    """The skeleton of a data set of this kind, y up, x left, z ahead.

    Attributes:
        chains: Joints from the root or a branch outwards; together every bone once.
        directions: Rest direction of the bone that ends in each joint [J, 3]; the root's is zero.
        owners: The canonical joint nearest to each joint.
        twins: The joint on the other side of each.
        face: Right hip, left hip, right shoulder, left shoulder.
        feet: Left heel, left toe, right heel, right toe.
        still: Squared way a frame below which a foot is in contact, in units of the data.
    """

    chains: tuple[tuple[int, ...], ...]
    directions: Array = field(repr=False)
    owners: tuple[int, ...]
    twins: tuple[int, ...]
    face: tuple[int, int, int, int]
    feet: tuple[int, int, int, int]
    still: float


class GuoFeatures(Layout, ABC):
    """Root, joint positions, 6D rotations, velocities and contacts in the frame of the heading.

    Blocks, y up, J joints: root_turn 1 (half angles to the right, rad a frame), root_step 2
    (x, z a frame, in the frame of the next heading), root_height 1, positions J - 1 x 3 (x and z
    relative to the root), rotations J - 1 x 6, joint_steps J x 3 (a frame), contacts 4.
    """

    name: str

    def __init__(self, skeleton: GuoSkeleton) -> None:
        self.skeleton = skeleton
        owners, twins = skeleton.owners, skeleton.twins
        below = tuple(t - 1 for t in twins[1:])
        super().__init__(
            Block("root_turn", ROOT, ODD_SCALAR),
            Block("root_step", ROOT, PLANAR),
            Block("root_height", ROOT, SCALAR),
            Block("positions", owners[1:], VECTOR, below),
            Block("rotations", owners[1:], COLUMNS, below),
            Block("joint_steps", owners, VECTOR, twins),
            Block("contacts", tuple(owners[j] for j in skeleton.feet), SCALAR, (2, 3, 0, 1)),
        )

    @abstractmethod
    def from_canonical(self, positions: Array) -> Array:
        """Return the data set's joints [T, J, 3], in its units, floor at its lowest joint.

        Args:
            positions: Canonical joints [T, 22, 3], m, y up, floor at the lowest toe joint.
        """

    @abstractmethod
    def to_canonical(self, positions: Array) -> Array:
        """Return canonical joints [T, 22, 3] on the data set's body, in its units."""

    def encode(self, motion: Motion) -> Array:
        """Return features [T, dim] of a motion; the last frame repeats the rates before."""
        positions = vectors_to_y_up(motion.positions - _TO_SOLE)
        return self.encode_positions(self.from_canonical(positions))

    def encode_positions(self, positions: Array) -> Array:
        """Return features [T, dim] of the data set's own joints [T, J, 3] over their floor."""
        positions = positions - positions[0, 0] * _GROUND
        face = _yaw(self._across(positions[:1], 1.0))
        positions = rot.rotate(rot.about_axis(_UP, -face)[:, None], positions)
        yaw = self._heading(positions)
        unturn = rot.about_axis(_UP, -yaw)
        steps = forward_difference(positions, 1.0)
        following = np.append(unturn[1:], unturn[-1:], axis=0)
        local = rot.rotate(unturn[:, None], positions - positions[:, :1] * _GROUND)
        moved = np.sum(steps[:, list(self.skeleton.feet)] ** 2, axis=-1)
        return self.join(
            {
                "root_turn": -0.5 * forward_difference(yaw, 1.0),
                "root_step": rot.rotate(following, steps[:, 0])[:, [0, 2]],
                "root_height": positions[:, 0, _UP],
                "positions": local[:, 1:],
                "rotations": rot.to_columns(self._rotations(positions, unturn))[:, 1:],
                "joint_steps": rot.rotate(unturn[:, None], steps),
                "contacts": moved < self.skeleton.still,
            }
        )

    def positions(self, features: Array) -> Array:
        """Return the data set's joints [T, J, 3], in its units, y up, that features hold."""
        f = self.split(features)
        turn = rot.about_axis(_UP, integrate(-2.0 * f["root_turn"][:, 0], 1.0))
        steps = np.insert(f["root_step"], 1, 0.0, axis=1)
        # a step is written in the frame it leads to
        steps = np.concatenate([np.zeros_like(steps[:1]), steps[:-1]])
        root = np.cumsum(rot.rotate(turn, steps), axis=0)
        below = rot.rotate(turn[:, None], f["positions"]) + root[:, None]
        root[:, _UP] = f["root_height"][:, 0]
        return np.concatenate([root[:, None], below], axis=1)

    def decode(self, features: Array, fps: float) -> Motion:
        """Return the motion of features [T, dim], carried over to the canonical skeleton.

        Positions decide, see `motion.from_positions`; sizes are scaled by leg length.
        """
        positions = vectors_to_z_up(self.to_canonical(self.positions(features)))
        motion = motion_from_positions(positions, fps)
        # their floor is at the lowest joint, ours below the sole
        return motion.with_root(motion.root + _TO_SOLE)

    def _across(self, positions: Array, hips: float) -> Array:
        """Return what points ahead [T, 3]: normal to the line from left to right, and to up."""
        right_hip, left_hip, right_shoulder, left_shoulder = (
            positions[:, j] for j in self.skeleton.face
        )
        across = rot.unit(hips * (right_hip - left_hip) + right_shoulder - left_shoulder)
        return np.cross([0.0, 1.0, 0.0], across)

    def _heading(self, positions: Array) -> Array:
        """Return the yaw of the heading [T], rad."""
        ahead = gaussian_filter1d(self._across(positions, -1.0), _SMOOTHING, axis=0, mode="nearest")
        yaw = np.unwrap(_yaw(ahead))
        yaw[0] = 0.0
        return yaw

    def _rotations(self, positions: Array, unturn: Array) -> Array:
        """Return the rotation stored at each joint [T, J, 4]."""
        local = rot.identity(*positions.shape[:2])
        for chain in self.skeleton.chains:
            before = unturn
            for start, end in pairwise(chain):
                bone = positions[:, end] - positions[:, start]
                world = rot.shortest_arc(self.skeleton.directions[end], bone)
                local[:, end] = rot.multiply(rot.conjugate(before), world)
                before = world
        return local


def _yaw(ahead: Array) -> Array:
    return np.arctan2(ahead[:, 0], ahead[:, 2])
