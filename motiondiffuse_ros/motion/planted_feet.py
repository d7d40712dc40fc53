"""Move the root of a pose state so that feet that stand stay put, in torch, for use in denoising.

PhysDiff (Yuan et al. 2023) projects onto what a simulator can follow at the last denoising steps.
This is the part of it that costs nothing: the pose is left as it is, and the root goes the way that
the standing feet imply.
"""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional as F

from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.kinematics import CONTACT_POSITIONS, PoseStateKinematics

_CERTAIN = 0.3
"""Contact labels up to this are taken for none."""

_SMOOTHING = (0.06, 0.24, 0.4, 0.24, 0.06)
"""Over neighbouring frames: poses jitter while they are denoised, and the root must not."""


class PlantedFeet:
    """Draws the root's velocity over the floor to that at which the feet in contact rest."""

    def __init__(self, fps: float, pull: float = 4.0) -> None:
        """Take the rate.

        Args:
            fps: Frame rate, Hz.
            pull: Weight of one foot joint in contact against the root's own velocity.
        """
        groups = PoseState().groups()
        self._planar, self._contacts = groups["root_velocity"], groups["contacts"]
        self._velocities = groups["velocities"]
        self._kinematics = PoseStateKinematics()
        self._feet = list(CONTACT_POSITIONS)
        self._fps, self._pull = fps, pull

    def __call__(self, features: Tensor) -> Tensor:
        """Return pose states [C, T, 269], denormalised, with the root's velocity changed."""
        if features.shape[1] < 2:
            return features
        slide = self._foot_velocities(features)[..., [0, 2]]
        contacts = features[:, :-1, self._contacts]
        certain = ((contacts - _CERTAIN) / (1.0 - _CERTAIN)).clamp(0.0, 1.0)
        weight = self._pull * certain[..., None]
        change = -(weight * slide).sum(2) / (1.0 + weight.sum(2))
        change = _smooth(F.pad(change, (0, 0, 0, 1)))
        features = features.clone()
        features[..., self._planar] += change
        features[..., self._velocities.start : self._velocities.stop : 3] += change[..., :1]
        features[..., self._velocities.start + 2 : self._velocities.stop : 3] += change[..., 1:]
        return features

    def _foot_velocities(self, features: Tensor) -> Tensor:
        """Return [C, T - 1, feet, 3], m/s, over the floor in the heading frame."""
        shape = features.shape[:2]
        places = self._kinematics.positions(features.flatten(0, 1)).unflatten(0, shape)
        velocities = self._kinematics.velocities(
            features[:, :-1].flatten(0, 1),
            places[:, :-1].flatten(0, 1),
            places[:, 1:].flatten(0, 1),
            self._fps,
        )
        return velocities.unflatten(0, (shape[0], shape[1] - 1))[:, :, self._feet]


def _smooth(values: Tensor) -> Tensor:
    """Return values [C, T, 2] averaged over neighbouring frames; the ends are repeated."""
    kernel = torch.tensor(_SMOOTHING, device=values.device)[None, None]
    columns = values.transpose(1, 2)
    half = len(_SMOOTHING) // 2
    padded = torch.cat(
        [columns[..., :1].expand(-1, -1, half), columns, columns[..., -1:].expand(-1, -1, half)], -1
    )
    smoothed = F.conv1d(padded.flatten(0, 1)[:, None], kernel)
    return smoothed[:, 0].unflatten(0, columns.shape[:2]).transpose(1, 2)
