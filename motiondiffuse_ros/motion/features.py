"""The pose state: the features that the diffusion model sees, with an exact inverse.

Follows Guo et al. 2022 (section 4.1 of the MotionDiffuse paper; HumanML3D's 263 numbers) with two
differences: the root's tilt rotation is kept, without which a bow or a fall loses the pelvis, and
velocities are per second. This is the only file that works in the y-up, z-forward frame.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS, detect_contacts
from motiondiffuse_ros.motion.frames import (
    quaternions_to_y_up,
    quaternions_to_z_up,
    vectors_to_y_up,
    vectors_to_z_up,
)
from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.parts import PARTS, part_joints
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


class PoseState:
    """Root velocities and height, joint positions, 6D rotations, velocities, contacts.

    Blocks of the 269 numbers, y up, in the frame of the root's heading:
        yaw_velocity 1 (rad/s), root_velocity 2 (x, z; m/s), root_height 1 (m),
        positions 21 x 3 (m; x and z relative to the root), rotations 22 x 6 (first two columns;
        the root's without its yaw), velocities 22 x 3 (m/s), contacts 4 (0 or 1).
    """

    name = "pose_state"

    def __init__(self) -> None:
        joints = len(CANONICAL.names)
        sizes = {
            "yaw_velocity": 1,
            "root_velocity": 2,
            "root_height": 1,
            "positions": 3 * (joints - 1),
            "rotations": 6 * joints,
            "velocities": 3 * joints,
            "contacts": len(CONTACT_JOINTS),
        }
        ends = np.cumsum(list(sizes.values()))
        self._groups = {
            name: slice(int(end - size), int(end))
            for (name, size), end in zip(sizes.items(), ends, strict=True)
        }
        self.dim = int(ends[-1])

    def groups(self) -> dict[str, slice]:
        """Return the named blocks of the feature vector."""
        return dict(self._groups)

    def encode(self, motion: Motion) -> Array:
        """Return features [T, 269] of a motion; at its own frame rate."""
        frames = motion.frames
        positions = vectors_to_y_up(motion.positions)
        rotations = quaternions_to_y_up(motion.rotations)
        yaw = np.unwrap(rot.twist_angle(rotations[:, 0], _UP))
        unturn = rot.about_axis(_UP, -yaw)

        yaw_velocity = _forward_difference(yaw[:, None], motion.fps)
        velocities = rot.rotate(unturn[:, None], _forward_difference(positions, motion.fps))
        ground = positions[:, :1] * [1.0, 0.0, 1.0]
        local = rot.rotate(unturn[:, None], positions - ground)
        rotations = rotations.copy()
        rotations[:, 0] = rot.multiply(unturn, rotations[:, 0])
        columns = np.swapaxes(rot.to_matrix(rotations)[..., :2], -1, -2)
        blocks = {
            "yaw_velocity": yaw_velocity,
            "root_velocity": velocities[:, 0, [0, 2]],
            "root_height": positions[:, 0, _UP],
            "positions": local[:, 1:],
            "rotations": columns,
            "velocities": velocities,
            "contacts": detect_contacts(motion),
        }
        return np.concatenate(
            [np.reshape(blocks[name], (frames, -1)) for name in self._groups], axis=1
        ).astype(np.float32)

    def decode(self, features: Array, fps: float) -> Motion:
        """Return the motion [T] of features [T, 269].

        Rotations and the integrated root path decide; joint positions follow by forward
        kinematics, so that bones never stretch.
        """
        f = {name: np.asarray(features[:, s], dtype=np.float64) for name, s in self._groups.items()}
        yaw = _integrate(f["yaw_velocity"][:, 0], fps)
        turn = rot.about_axis(_UP, yaw)
        planar = f["root_velocity"]
        velocity = np.stack([planar[:, 0], np.zeros(len(planar)), planar[:, 1]], axis=-1)
        root = _integrate(rot.rotate(turn, velocity), fps)
        root[:, _UP] = f["root_height"][:, 0]

        a, b = np.moveaxis(f["rotations"].reshape(len(features), -1, 2, 3), -2, 0)
        rotations = rot.from_matrix(_gram_schmidt(a, b))
        # a sampled tilt may hold a little yaw; the heading is the yaw velocity's alone
        turn = rot.multiply(turn, rot.about_axis(_UP, -rot.twist_angle(rotations[:, 0], _UP)))
        rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
        return Motion(vectors_to_z_up(root), quaternions_to_z_up(rotations), fps, CANONICAL)

    def part_indices(self, part: str) -> Indices:
        """Return the indices a part owns; the root's blocks and the contacts go with the legs."""
        owned: list[int] = []
        if "pelvis" in PARTS[part]:
            for name in ("yaw_velocity", "root_velocity", "root_height", "contacts"):
                owned += range(self._groups[name].start, self._groups[name].stop)
        for joint in part_joints(part):
            if joint > 0:
                start = self._groups["positions"].start + 3 * (joint - 1)
                owned += range(start, start + 3)
            start = self._groups["rotations"].start + 6 * joint
            owned += range(start, start + 6)
            start = self._groups["velocities"].start + 3 * joint
            owned += range(start, start + 3)
        return np.array(sorted(owned))

    def mirror(self) -> tuple[Indices, Array]:
        """Return (index, sign) [269] such that `features[:, index] * sign` is the mirror image."""
        index = np.arange(self.dim)
        sign = np.ones(self.dim, dtype=np.float32)
        swap = np.array(CANONICAL.mirror_index)
        vector = np.array([-1.0, 1.0, 1.0])  # x is left
        # both kept columns of M R M, M = diag(-1, 1, 1)
        columns = np.array([1.0, -1.0, -1.0, -1.0, 1.0, 1.0])

        def joints(name: str, order: Indices, signs: Array) -> None:
            s = self._groups[name]
            index[s] = s.start + (order[:, None] * len(signs) + np.arange(len(signs))).ravel()
            sign[s] = np.tile(signs, len(order))

        joints("positions", swap[1:] - 1, vector)
        joints("rotations", swap, columns)
        joints("velocities", swap, vector)
        joints("contacts", np.array([2, 3, 0, 1]), np.ones(1))
        sign[self._groups["yaw_velocity"]] = -1.0
        sign[self._groups["root_velocity"]] = [-1.0, 1.0]
        return index, sign


REPRESENTATIONS: dict[str, type[PoseState]] = {PoseState.name: PoseState}


def _forward_difference(x: Array, fps: float) -> Array:
    """Return per-second forward differences along axis 0; the last one is repeated."""
    if len(x) < 2:
        return np.zeros_like(x)
    step = np.diff(x, axis=0) * fps
    return np.concatenate([step, step[-1:]])


def _integrate(rate: Array, fps: float) -> Array:
    """Undo `_forward_difference`, starting at zero."""
    return np.concatenate([np.zeros_like(rate[:1]), np.cumsum(rate[:-1], axis=0) / fps])


def _gram_schmidt(a: Array, b: Array) -> Array:
    """Return rotation matrices [..., 3, 3] nearest to columns a and b (Zhou et al. 2019)."""
    eps = 1e-8  # a sampled column may vanish; any direction is then as good
    x = a / np.maximum(np.linalg.norm(a, axis=-1, keepdims=True), eps)
    y = b - np.sum(x * b, axis=-1, keepdims=True) * x
    y = y / np.maximum(np.linalg.norm(y, axis=-1, keepdims=True), eps)
    return np.stack([x, y, np.cross(x, y)], axis=-1)
