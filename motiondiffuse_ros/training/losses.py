"""What the denoiser is trained to minimise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import torch
from torch import Tensor

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.attention import pad_mask
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.motion.kinematics import CONTACT_POSITIONS, PoseStateKinematics

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
_PAIR_STEP = 8  # forward kinematics is costly: a pair of neighbours in every eight frames has it


class LossWeights(Protocol):
    """Settings that weigh the terms against that of the features."""

    @property
    def difference_weight(self) -> float: ...
    @property
    def position_weight(self) -> float: ...
    @property
    def velocity_weight(self) -> float: ...
    @property
    def slide_weight(self) -> float: ...


@dataclass(frozen=True)
class Losses:
    """Loss terms of one batch, each a scalar.

    Attributes:
        features: Weighted squared error of the clean features.
        difference: The same of frame-to-frame differences.
        position: Squared error of joint positions by forward kinematics, normalised.
        velocity: Squared error of joint velocities over the floor, by forward kinematics and the
            root's own velocity, normalised. It ties the steps to the way the root goes.
        slide: Error of the feet's velocities while they are in contact, m/s; linear, since small
            slides are what is seen.
        plain: Unweighted squared error, for comparison between runs.
    """

    features: Tensor
    difference: Tensor
    position: Tensor
    velocity: Tensor
    slide: Tensor
    plain: Tensor

    def weighed(self, weights: LossWeights) -> Tensor:
        """Return the sum that is minimised."""
        return (
            self.features
            + weights.difference_weight * self.difference
            + weights.position_weight * self.position
            + weights.velocity_weight * self.velocity
            + weights.slide_weight * self.slide
        )


class MotionLoss:
    """Compares predicted with true clean features."""

    def __init__(self, representation: Representation, statistics: Statistics, fps: float) -> None:
        groups = representation.groups()
        weight = torch.zeros(representation.dim)
        for name, block in groups.items():
            weight[block] = _SHARES[name] / (block.stop - block.start)
        self._weight = weight
        self._mean = torch.from_numpy(statistics.mean)
        self._std = torch.from_numpy(statistics.std)
        self._positions, self._contacts = groups["positions"], groups["contacts"]
        velocities = groups["velocities"]
        self._velocities = slice(velocities.start + 3, velocities.stop)  # the root's are no joint's
        self._kinematics = PoseStateKinematics()
        self._fps = fps

    def __call__(
        self, predicted: Tensor, true: Tensor, lengths: Tensor, phase: int, weight: Tensor
    ) -> Losses:
        """Return the losses.

        Args:
            predicted: Normalised clean features [B, T, D].
            true: The same, of the data.
            lengths: Frames that count [B].
            phase: Which of every `_PAIR_STEP` frames carry the losses by forward kinematics.
            weight: Of each window [B]; `plain` ignores it.
        """
        mask = pad_mask(lengths, true.shape[1])
        squared = (predicted - true).square()
        by_frame = weight[:, None].expand(mask.shape)
        features = (squared @ self._weight * by_frame)[mask].mean()
        plain = squared.detach().mean(-1)[mask].mean()
        step = (predicted[:, 1:] - predicted[:, :-1]) - (true[:, 1:] - true[:, :-1])
        difference = (step.square() @ self._weight * by_frame[:, 1:])[mask[:, 1:]].mean()
        kinematic = self._kinematic(predicted, true, mask, phase, by_frame)
        return Losses(features, difference, *kinematic, plain)

    def _kinematic(
        self, predicted: Tensor, true: Tensor, mask: Tensor, phase: int, by_frame: Tensor
    ) -> tuple[Tensor, Tensor, Tensor]:
        first = torch.arange(phase % _PAIR_STEP, true.shape[1] - 1, _PAIR_STEP)
        keep = mask[:, first + 1]
        pairs = [predicted[:, i][keep] * self._std + self._mean for i in (first, first + 1)]
        here, there = self._kinematics.positions(torch.cat(pairs)).chunk(2)
        velocities = self._kinematics.velocities(pairs[0], here, there, self._fps)
        now, then = true[:, first][keep], true[:, first + 1][keep]
        weight = by_frame[:, first][keep]
        position = 0.5 * (
            self._error(here, now, self._positions, weight)
            + self._error(there, then, self._positions, weight)
        )
        truth = (now * self._std + self._mean)[:, self._velocities].unflatten(1, (-1, 3))
        contacts = (now * self._std + self._mean)[:, self._contacts] > 0.5
        feet = (velocities - truth)[:, CONTACT_POSITIONS].norm(dim=-1)
        slide = (feet * contacts * weight[:, None]).sum() / contacts.sum().clamp(min=1)
        return position, self._error(velocities, now, self._velocities, weight), slide

    def _error(self, values: Tensor, true: Tensor, block: slice, weight: Tensor) -> Tensor:
        normalised = (values.flatten(1) - self._mean[block]) / self._std[block]
        return ((normalised - true[:, block]).square().mean(-1) * weight).mean()
