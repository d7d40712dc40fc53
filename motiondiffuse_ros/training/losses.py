"""What the denoiser is trained to minimise."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.attention import pad_mask
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.kinematics import PoseStateKinematics

# Share of each block in the loss. Only the root's blocks and the rotations are decoded; evenly by
# number the root's four would drown in 269.
_SHARES = {
    "yaw_velocity": 0.05,
    "root_velocity": 0.10,
    "root_height": 0.05,
    "positions": 0.20,
    "rotations": 0.40,
    "velocities": 0.15,
    "contacts": 0.05,
}
_POSITION_FRAMES = 4  # forward kinematics is costly: every fourth frame carries its loss


@dataclass(frozen=True)
class Losses:
    """Loss terms of one batch, each a scalar.

    Attributes:
        features: Weighted squared error of the clean features.
        difference: The same of frame-to-frame differences.
        position: Squared error of joint positions by forward kinematics, normalised.
        plain: Unweighted squared error, for comparison between runs.
    """

    features: Tensor
    difference: Tensor
    position: Tensor
    plain: Tensor


class MotionLoss:
    """Compares predicted with true clean features."""

    def __init__(self, representation: Representation, statistics: Statistics) -> None:
        weight = torch.zeros(representation.dim)
        for name, block in representation.groups().items():
            weight[block] = _SHARES[name] / (block.stop - block.start)
        self._weight = weight
        self._mean = torch.from_numpy(statistics.mean)
        self._std = torch.from_numpy(statistics.std)
        self._positions = representation.groups()["positions"]
        self._kinematics = PoseStateKinematics()

    def __call__(self, predicted: Tensor, true: Tensor, lengths: Tensor, phase: int) -> Losses:
        """Return the losses.

        Args:
            predicted: Normalised clean features [B, T, D].
            true: The same, of the data.
            lengths: Frames that count [B].
            phase: Which of every `_POSITION_FRAMES` frames carry the position loss.
        """
        mask = pad_mask(lengths, true.shape[1])
        squared = (predicted - true).square()
        features = (squared @ self._weight)[mask].mean()
        plain = squared.detach().mean(-1)[mask].mean()
        step = (predicted[:, 1:] - predicted[:, :-1]) - (true[:, 1:] - true[:, :-1])
        difference = (step.square() @ self._weight)[mask[:, 1:]].mean()
        return Losses(features, difference, self._position(predicted, true, mask, phase), plain)

    def _position(self, predicted: Tensor, true: Tensor, mask: Tensor, phase: int) -> Tensor:
        chosen = (slice(None), slice(phase % _POSITION_FRAMES, None, _POSITION_FRAMES))
        keep = mask[chosen]
        rows = predicted[chosen][keep] * self._std + self._mean
        target = true[chosen][keep][:, self._positions]
        positions = self._kinematics.positions(rows).flatten(1)
        normalised = (positions - self._mean[self._positions]) / self._std[self._positions]
        return (normalised - target).square().mean()
