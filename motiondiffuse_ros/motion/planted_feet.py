"""Move the root of a pose state so that feet that stand stay put, in torch, for use in denoising.

PhysDiff (Yuan et al. 2023) projects onto what a simulator can follow at the last denoising steps.
This is the part of it that costs nothing: the pose is left as it is, and the root goes the way that
the standing feet imply, as high over the floor as they are below it.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor
from torch.nn import functional as F

from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.kinematics import CONTACT_POSITIONS, PoseStateKinematics
from motiondiffuse_ros.motion.skeleton import (
    ANKLE_HEIGHT,
    CANONICAL,
    HEEL_BEHIND_ANKLE,
    TOE_HEIGHT,
)

_CERTAIN = 0.3
"""Contact labels up to this are taken for none."""

_SLIDE_FRAMES, _HEIGHT_FRAMES = 1.0, 3.0
"""Standard deviation of the smoothing over time: poses jitter while they are denoised, and the root
must not; nor may it jump where a contact begins."""

_DRIFT_FRAMES = 10.0
"""What is slower than this goes on sideways: feet drag in sampled sidesteps, and a body that they
hold stays where it is."""

_FLAT = CANONICAL.offsets[CANONICAL.index("left_foot")]
_FLAT_PITCH = math.atan2(_FLAT[2], math.hypot(_FLAT[0], _FLAT[1]))


class PlantedFeet:
    """Draws the root to where the feet in contact rest on the floor."""

    def __init__(self, fps: float, pull: float = 10.0, height_pull: float = 20.0) -> None:
        """Take the rate.

        Args:
            fps: Frame rate, Hz.
            pull: Weight of one foot joint in contact against the root's own velocity.
            height_pull: Weight of the sole that is lowest against the root's own height.
        """
        groups = PoseState().groups()
        self._planar, self._contacts = groups["root_velocity"], groups["contacts"]
        self._height, self._positions = groups["root_height"], groups["positions"]
        self._velocities = groups["velocities"]
        self._kinematics = PoseStateKinematics()
        self._feet = list(CONTACT_POSITIONS)
        self._fps, self._pull, self._height_pull = fps, pull, height_pull

    def __call__(self, features: Tensor) -> Tensor:
        """Return pose states [C, T, 269], denormalised, with the root's path changed."""
        if features.shape[1] < 2:
            return features
        features = features.clone()
        labels = features[..., self._contacts]
        certain = ((labels - _CERTAIN) / (1.0 - _CERTAIN)).clamp(0.0, 1.0)
        shape = features.shape[:2]
        places = self._kinematics.positions(features.flatten(0, 1)).unflatten(0, shape)
        self._hold(features, places, certain)
        self._level(features, places, certain)
        return features

    def _hold(self, features: Tensor, places: Tensor, certain: Tensor) -> None:
        """Change the root's velocity over the floor."""
        slide = self._foot_velocities(features, places)[..., [0, 2]]
        weight = self._pull * certain[:, :-1, :, None]
        change = -(weight * slide).sum(2) / (1.0 + weight.sum(2))
        change = _smooth(F.pad(change, (0, 0, 0, 1)), _SLIDE_FRAMES)
        change[..., 0] -= _smooth(change[..., :1], _DRIFT_FRAMES)[..., 0]
        features[..., self._planar] += change
        features[..., self._velocities.start : self._velocities.stop : 3] += change[..., :1]
        features[..., self._velocities.start + 2 : self._velocities.stop : 3] += change[..., 1:]

    def _level(self, features: Tensor, places: Tensor, certain: Tensor) -> None:
        """Change the root's height, in flight by what the nearest contacts ask for."""
        certain = certain.amax(2, keepdim=True)
        above = self._sole_heights(places).amin(2, keepdim=True)
        missing = _smooth(certain * above, _HEIGHT_FRAMES)
        support = _smooth(certain, _HEIGHT_FRAMES)
        change = -missing / (support + 1.0 / self._height_pull)
        features[..., self._height] += change
        features[..., self._positions.start + 1 : self._positions.stop : 3] += change
        speed = change.diff(dim=1) * self._fps
        speed = torch.cat([speed, speed[:, -1:]], dim=1)
        features[..., self._velocities.start + 1 : self._velocities.stop : 3] += speed

    def _sole_heights(self, places: Tensor) -> Tensor:
        """Return the height [C, T, 2], m, of the lower of heel and ball of each foot."""
        feet = places[:, :, self._feet].unflatten(2, (2, 2))
        ankle, toe = feet.unbind(3)
        ahead = toe - ankle
        pitch = torch.atan2(ahead[..., 1], ahead[..., [0, 2]].norm(dim=-1)) - _FLAT_PITCH
        heel = ankle[..., 1] - ANKLE_HEIGHT * pitch.cos() - HEEL_BEHIND_ANKLE * pitch.sin()
        return torch.minimum(heel, toe[..., 1] - TOE_HEIGHT * pitch.cos())

    def _foot_velocities(self, features: Tensor, places: Tensor) -> Tensor:
        """Return [C, T - 1, feet, 3], m/s, over the floor in the heading frame."""
        velocities = self._kinematics.velocities(
            features[:, :-1].flatten(0, 1),
            places[:, :-1].flatten(0, 1),
            places[:, 1:].flatten(0, 1),
            self._fps,
        )
        return velocities.unflatten(0, (len(features), -1))[:, :, self._feet]


def _smooth(values: Tensor, frames: float) -> Tensor:
    """Return values [C, T, K] averaged over neighbouring frames; the ends are repeated.

    Args:
        values: Over time.
        frames: Standard deviation of the Gaussian.
    """
    half = math.ceil(2.0 * frames)
    kernel = torch.exp(-0.5 * (torch.arange(-half, half + 1, device=values.device) / frames) ** 2)
    kernel = (kernel / kernel.sum())[None, None]
    columns = values.transpose(1, 2)
    padded = torch.cat(
        [columns[..., :1].expand(-1, -1, half), columns, columns[..., -1:].expand(-1, -1, half)], -1
    )
    smoothed = F.conv1d(padded.flatten(0, 1)[:, None], kernel)
    return smoothed[:, 0].unflatten(0, columns.shape[:2]).transpose(1, 2)
