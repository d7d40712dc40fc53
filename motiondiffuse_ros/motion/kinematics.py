"""Forward kinematics on normalisable features in torch, for losses that see where joints end up."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from motiondiffuse_ros.light_import import light_import
from motiondiffuse_ros.motion.contacts import CONTACT_JOINTS
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.frames import vectors_to_y_up
from motiondiffuse_ros.motion.skeleton import CANONICAL

with light_import():
    import roma

CONTACT_POSITIONS = tuple(CANONICAL.index(name) - 1 for name in CONTACT_JOINTS)
"""Where the contact joints are among the joints below the root."""

_FRAMES = 4096
"""At once; every frame takes 6 kB meanwhile."""


class PoseStateKinematics:
    """Joint positions and velocities that a pose state's decoded blocks imply."""

    def __init__(self) -> None:
        groups = PoseState().groups()
        self._rotations, self._height = groups["rotations"], groups["root_height"]
        self._yaw_velocity, self._root_velocity = groups["yaw_velocity"], groups["root_velocity"]
        offsets = vectors_to_y_up(CANONICAL.offsets).astype(np.float32)
        self._offsets = torch.from_numpy(offsets)
        # joints of one depth are computed together: eight small products instead of 21
        depth = [0]
        for parent in CANONICAL.parents[1:]:
            depth.append(depth[parent] + 1)
        self._levels = [
            torch.tensor([j for j, d in enumerate(depth) if d == level])
            for level in range(1, max(depth) + 1)
        ]
        self._parents = torch.tensor(CANONICAL.parents)

    def positions(self, features: Tensor) -> Tensor:
        """Return positions [N, 21, 3], m, y up, in the heading frame under the root.

        Args:
            features: Denormalised pose states [N, 269].
        """
        return torch.cat([self._positions(piece) for piece in features.split(_FRAMES)])

    def _positions(self, features: Tensor) -> Tensor:
        columns = features[:, self._rotations].unflatten(-1, (-1, 2, 3)).transpose(-1, -2)
        local = roma.special_gramschmidt(columns.float())
        up = torch.tensor([0.0, 1.0, 0.0])
        world = {0: local[:, 0]}
        place = {0: features[:, self._height].float() * up}
        for joints in self._levels:
            parents = self._parents[joints].tolist()
            turn = torch.stack([world[p] for p in parents], dim=1)
            here = torch.stack([place[p] for p in parents], dim=1)
            here = here + (turn * self._offsets[joints][None, :, None, :]).sum(-1)
            turn = turn @ local[:, joints]
            for i, j in enumerate(joints.tolist()):
                world[j], place[j] = turn[:, i], here[:, i]
        return torch.stack([place[j] for j in range(1, len(place))], dim=1)

    def velocities(self, features: Tensor, here: Tensor, there: Tensor, fps: float) -> Tensor:
        """Return the joints' velocities [N, 21, 3] over the floor, m/s, in the heading frame.

        Args:
            features: Denormalised pose states [N, 269] of the first of two frames.
            here: `positions` of that frame.
            there: `positions` of the next one, in its own heading frame.
            fps: Frame rate, Hz.
        """
        turn = features[:, self._yaw_velocity].float() / fps
        sine, cosine = turn.sin(), turn.cos()
        x, y, z = there.unbind(-1)
        turned = torch.stack([cosine * x + sine * z, y, cosine * z - sine * x], dim=-1)
        root = features[:, self._root_velocity].float()
        moved = torch.stack([root[:, 0], torch.zeros_like(root[:, 0]), root[:, 1]], dim=-1)
        return (turned - here) * fps + moved[:, None]
