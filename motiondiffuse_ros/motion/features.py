"""The pose state: the features that the diffusion model sees, with an exact inverse.

Follows Guo et al. 2022 (section 4.1 of the MotionDiffuse paper; HumanML3D's 263 numbers) with two
differences: the root's tilt rotation is kept, without which a bow or a fall loses the pelvis, and
velocities are per second. Works in the y-up, z-forward frame, as all representations do.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS, detect_contacts
from motiondiffuse_ros.motion.differences import forward_difference, integrate
from motiondiffuse_ros.motion.frames import (
    quaternions_to_y_up,
    quaternions_to_z_up,
    vectors_to_y_up,
    vectors_to_z_up,
)
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
from motiondiffuse_ros.motion.representations import (
    HumanML3D,
    JointPositions,
    KitML,
    RootRotations,
)
from motiondiffuse_ros.motion.rotations import Array, Indices
from motiondiffuse_ros.motion.skeleton import CANONICAL

_UP = 1  # axis index of the y-up frame


class Representation(Protocol):
    """How a motion becomes a matrix of features and comes back."""

    name: str
    dim: int

    def encode(self, motion: Motion) -> Array:
        """Return features [T, dim]."""
        ...

    def decode(self, features: Array, fps: float) -> Motion:
        """Return the motion of features [T, dim]; starts over the origin, facing +x."""
        ...

    def groups(self) -> dict[str, slice]:
        """Return the named blocks of the feature vector."""
        ...

    def part_indices(self, part: str) -> Indices:
        """Return the feature indices that a body part owns."""
        ...

    def mirror(self) -> tuple[Indices, Array]:
        """Return (index, sign): `features[:, index] * sign` is the mirrored motion."""
        ...


class PoseState(Layout):
    """Root velocities and height, joint positions, 6D rotations, velocities, contacts.

    Blocks of the 269 numbers, y up, in the frame of the root's heading:
        yaw_velocity 1 (rad/s), root_velocity 2 (x, z; m/s), root_height 1 (m),
        positions 21 x 3 (m; x and z relative to the root), rotations 22 x 6 (first two columns;
        the root's without its yaw), velocities 22 x 3 (m/s), contacts 4 (0 or 1).
    """

    name = "pose_state"

    def __init__(self) -> None:
        joints = tuple(range(len(CANONICAL.names)))
        super().__init__(
            Block("yaw_velocity", ROOT, ODD_SCALAR),
            Block("root_velocity", ROOT, PLANAR),
            Block("root_height", ROOT, SCALAR),
            Block("positions", joints[1:], VECTOR),
            Block("rotations", joints, COLUMNS),
            Block("velocities", joints, VECTOR),
            Block("contacts", tuple(map(CANONICAL.index, CONTACT_JOINTS)), SCALAR),
        )

    def encode(self, motion: Motion) -> Array:
        """Return features [T, 269] of a motion; at its own frame rate."""
        positions = vectors_to_y_up(motion.positions)
        rotations = quaternions_to_y_up(motion.rotations)
        yaw = np.unwrap(rot.twist_angle(rotations[:, 0], _UP))
        unturn = rot.about_axis(_UP, -yaw)

        yaw_velocity = forward_difference(yaw[:, None], motion.fps)
        velocities = rot.rotate(unturn[:, None], forward_difference(positions, motion.fps))
        ground = positions[:, :1] * [1.0, 0.0, 1.0]
        local = rot.rotate(unturn[:, None], positions - ground)
        rotations = rotations.copy()
        rotations[:, 0] = rot.multiply(unturn, rotations[:, 0])
        return self.join(
            {
                "yaw_velocity": yaw_velocity,
                "root_velocity": velocities[:, 0, [0, 2]],
                "root_height": positions[:, 0, _UP],
                "positions": local[:, 1:],
                "rotations": rot.to_columns(rotations),
                "velocities": velocities,
                "contacts": detect_contacts(motion),
            }
        )

    def decode(self, features: Array, fps: float) -> Motion:
        """Return the motion [T] of features [T, 269].

        Rotations and the integrated root path decide; joint positions follow by forward
        kinematics, so that bones never stretch.
        """
        f = self.split(features)
        yaw = integrate(f["yaw_velocity"][:, 0], fps)
        turn = rot.about_axis(_UP, yaw)
        planar = f["root_velocity"]
        velocity = np.stack([planar[:, 0], np.zeros(len(planar)), planar[:, 1]], axis=-1)
        root = integrate(rot.rotate(turn, velocity), fps)
        root[:, _UP] = f["root_height"][:, 0]

        rotations = rot.from_columns(f["rotations"])
        # a sampled tilt may hold a little yaw; the heading is the yaw velocity's alone
        turn = rot.multiply(turn, rot.about_axis(_UP, -rot.twist_angle(rotations[:, 0], _UP)))
        rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
        return Motion(vectors_to_z_up(root), quaternions_to_z_up(rotations), fps, CANONICAL)


REPRESENTATIONS: dict[str, type[Representation]] = {
    r.name: r for r in (PoseState, HumanML3D, KitML, JointPositions, RootRotations)
}
"""Every representation by name; a corpus has one."""
