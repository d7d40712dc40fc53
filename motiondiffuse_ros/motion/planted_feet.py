"""Make the feet of a pose state that stand stay put, in torch, for use in denoising.

PhysDiff (Yuan et al. 2023) projects onto what a simulator can follow at the last denoising steps.
This is the part of it that costs next to nothing: legs reach to where their standing foot rests,
and the root is as high over the floor as the soles are below it. The root's way over the floor is
left alone: steps are drawn shorter than the way, and a root that feet may hold walks too slowly for
what the text says.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from scipy.linalg import solveh_banded
from torch import Tensor
from torch.nn import functional as F

from motiondiffuse_ros.light_import import light_import
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.kinematics import CONTACT_POSITIONS, PoseStateKinematics
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import (
    ANKLE_HEIGHT,
    CANONICAL,
    HEEL_BEHIND_ANKLE,
    SIDES,
    TOE_HEIGHT,
)

with light_import():
    import roma

_CERTAIN = 0.15
"""Contact labels up to this are taken for none."""

_HEIGHT_FRAMES = 3.0
"""Standard deviation of the smoothing over time: poses jitter while they are denoised, and the root
must not; nor may it jump where a contact begins."""

_SUNK = 0.02
"""A sole this far below the floor [m] counts like one in certain contact."""

_LIFT_FRAMES, _LIFT_WINDOW = 2.0, 5
"""Smoothing of what lifts the soles that are then still below it, and over how many frames the
deepest of them counts."""

_PACE, _PACE_FRAMES = (1.6, 2.4), 6.0
"""Speeds of the root [m/s] at a fast walk and a slow run, and the smoothing over time they get."""

_RUNNING = 0.05
"""What standing counts in a run: feet stand for two or three frames there, and a leg that is held
over so few of them kicks."""

_REACH = 0.2
"""Legs reach less far than this from where they were drawn, m."""

_FLAT = CANONICAL.offsets[CANONICAL.index("left_foot")]
_FLAT_PITCH = math.atan2(_FLAT[2], math.hypot(_FLAT[0], _FLAT[1]))


_LEGS = tuple(
    tuple(CANONICAL.index(f"{side}_{joint}") for joint in ("hip", "knee", "ankle"))
    for side in SIDES
)


@dataclass(frozen=True)
class PlantingWeights:
    """What the legs' reach is weighed by; squares are summed over frames.

    Attributes:
        standing: That a foot in certain contact moves over the floor, against the others.
        own_velocity: That the reach changes, in contact or not.
        own_place: That there is any reach: a stance is shared between its start and its end.
        smooth: That the change of the reach changes, at the beginning and end of a contact.
        height: That the lowest sole is on the floor, against the root's own height.
        doubt: The power of a contact's certainty that is its weight there; the higher, the less do
            uncertain contacts keep the body down.
    """

    standing: float = 10.0
    own_velocity: float = 0.05
    own_place: float = 0.02
    smooth: float = 0.2
    height: float = 20.0
    doubt: float = 1.0


WHILE_DENOISING = PlantingWeights(doubt=8.0)
"""Between a jump and none the denoiser predicts half a contact, which must not end the jump."""


class PlantedFeet:
    """Moves the legs to where feet in contact rest, and the root to where soles touch the floor."""

    def __init__(self, fps: float, weights: PlantingWeights | None = None) -> None:
        """Take the rate [Hz], and weights other than the default ones."""
        groups = PoseState().groups()
        self._contacts, self._rotations = groups["contacts"], groups["rotations"]
        self._height, self._positions = groups["root_height"], groups["positions"]
        self._velocities = groups["velocities"]
        self._kinematics = PoseStateKinematics()
        self._feet = list(CONTACT_POSITIONS)
        self._fps, self._weights = fps, weights or PlantingWeights()

    def __call__(self, features: Tensor) -> Tensor:
        """Return pose states [C, T, 269], denormalised, with legs and the root's height changed."""
        if features.shape[1] < 3 or not torch.isfinite(features).all():
            return features
        features = features.clone()
        labels = features[..., self._contacts]
        certain = ((labels - _CERTAIN) / (1.0 - _CERTAIN)).clamp(0.0, 1.0)
        shape = features.shape[:2]
        places = self._kinematics.positions(features.flatten(0, 1)).unflatten(0, shape)
        speeds = self._speeds(features, places)
        reach = self._reach(speeds[:, :, self._feet], certain * self._walking(features))
        places = self._bend(features, places, speeds, reach)
        self._level(features, places, certain)
        return features

    def _walking(self, features: Tensor) -> Tensor:
        """Return how much standing counts [C, T, 1], by the pace of the root."""
        root = features[..., self._velocities][..., [0, 2]].norm(dim=-1, keepdim=True)
        walk, run = _PACE
        return ((run - _smooth(root, _PACE_FRAMES)) / (run - walk)).clamp(_RUNNING, 1.0)

    def _reach(self, speeds: Tensor, certain: Tensor) -> Tensor:
        """Return how far each foot has to be moved [C, feet, T, 2], m, x and z.

        The sum of squares in `PlantingWeights` is least; a foot's contact is that of its ankle or
        its toe, whichever is more certain.
        """
        weights = self._weights
        slides = speeds[..., [0, 2]].unflatten(2, (2, 2))
        contact = certain[:, :-1].unflatten(2, (2, 2))
        slide = (contact[..., None] * slides).sum(3) / contact.sum(3)[..., None].clamp(min=1e-6)
        standing = weights.standing * contact.amax(3).transpose(1, 2)
        against = standing[..., None] * slide.transpose(1, 2) / self._fps
        pull = F.pad(against, (0, 0, 0, 1)) - F.pad(against, (0, 0, 1, 0))
        bands = self._bands(standing.cpu().double().numpy())
        solved = [
            [solveh_banded(band, side, lower=True) for band, side in zip(*both, strict=True)]
            for both in zip(bands, pull.cpu().double().numpy(), strict=True)
        ]
        reach = torch.from_numpy(np.array(solved)).to(pull)
        return _REACH * torch.tanh(reach / _REACH)

    def _bands(self, standing: Array) -> Array:
        """Return the sum of squares as bands below the diagonal [C, feet, 3, T]."""
        weights, changes = self._weights, standing + self._weights.own_velocity
        bands = np.zeros((*standing.shape[:2], 3, standing.shape[2] + 1))
        diagonal, next_one, second = bands[..., 0, :], bands[..., 1, :], bands[..., 2, :]
        diagonal += weights.own_place
        diagonal[..., 1:] += changes
        diagonal[..., :-1] += changes
        next_one[..., :-1] -= changes
        # of the second difference, (1, -2, 1)
        for first, square in enumerate((1.0, 4.0, 1.0)):
            diagonal[..., first : first + changes.shape[2] - 1] += weights.smooth * square
        for first in (0, 1):
            next_one[..., first : first + changes.shape[2] - 1] -= 2.0 * weights.smooth
        second[..., :-2] += weights.smooth
        return bands

    def _bend(self, features: Tensor, places: Tensor, speeds: Tensor, reach: Tensor) -> Tensor:
        """Turn each leg at its hip by its reach, and the foot back; returns the new places."""
        columns = features[..., self._rotations].unflatten(-1, (-1, 2, 3)).transpose(-1, -2)
        local = roma.special_gramschmidt(columns)
        root = local[:, :, 0]
        for leg, (hip, knee, ankle) in enumerate(_LEGS):
            # places leave out the root; a leg that is folded up cannot swing
            length = (places[:, :, hip - 1, 1] - places[:, :, ankle - 1, 1]).clamp(min=0.3)
            x, z = (reach[:, leg] / length[..., None]).unbind(-1)
            turn = roma.rotvec_to_rotmat(torch.stack([-z, torch.zeros_like(x), x], dim=-1))
            shank = root @ local[:, :, hip] @ local[:, :, knee]
            local[:, :, hip] = root.mT @ turn @ root @ local[:, :, hip]
            local[:, :, ankle] = shank.mT @ turn.mT @ shank @ local[:, :, ankle]
        features[..., self._rotations] = local[..., :2].mT.flatten(2)
        shape = features.shape[:2]
        moved = self._kinematics.positions(features.flatten(0, 1)).unflatten(0, shape)
        features[..., self._positions] += (moved - places).flatten(2)
        faster = _and_last(self._speeds(features, moved) - speeds).flatten(2)
        features[..., self._velocities.start + 3 : self._velocities.stop] += faster
        return moved

    def _level(self, features: Tensor, places: Tensor, certain: Tensor) -> None:
        """Change the root's height, in flight by what the nearest contacts ask for."""
        above = self._sole_heights(places).amin(2, keepdim=True)
        certain = certain.amax(2, keepdim=True) ** self._weights.doubt
        certain = torch.maximum(certain, (-above / _SUNK).clamp(0.0, 1.0))
        missing = _smooth(certain * above, _HEIGHT_FRAMES)
        support = _smooth(certain, _HEIGHT_FRAMES)
        change = -missing / (support + 1.0 / self._weights.height)
        below = (-above - change).clamp(min=0.0).transpose(1, 2)
        deepest = F.max_pool1d(below, _LIFT_WINDOW, 1, _LIFT_WINDOW // 2).transpose(1, 2)
        change = change + _smooth(deepest, _LIFT_FRAMES)
        features[..., self._height] += change
        features[..., self._positions.start + 1 : self._positions.stop : 3] += change
        rise = _and_last(change.diff(dim=1) * self._fps)
        features[..., self._velocities.start + 1 : self._velocities.stop : 3] += rise

    def _sole_heights(self, places: Tensor) -> Tensor:
        """Return the height [C, T, 2], m, of the lower of heel and ball of each foot."""
        feet = places[:, :, self._feet].unflatten(2, (2, 2))
        ankle, toe = feet.unbind(3)
        ahead = toe - ankle
        pitch = torch.atan2(ahead[..., 1], ahead[..., [0, 2]].norm(dim=-1)) - _FLAT_PITCH
        heel = ankle[..., 1] - ANKLE_HEIGHT * pitch.cos() - HEEL_BEHIND_ANKLE * pitch.sin()
        return torch.minimum(heel, toe[..., 1] - TOE_HEIGHT * pitch.cos())

    def _speeds(self, features: Tensor, places: Tensor) -> Tensor:
        """Return joint velocities [C, T - 1, 21, 3], m/s, over the floor in the heading frame."""
        velocities = self._kinematics.velocities(
            features[:, :-1].flatten(0, 1),
            places[:, :-1].flatten(0, 1),
            places[:, 1:].flatten(0, 1),
            self._fps,
        )
        return velocities.unflatten(0, (len(features), -1))


def _and_last(values: Tensor) -> Tensor:
    """Return values between frames [C, T - 1, ...] for all frames, the last as the one before."""
    return torch.cat([values, values[:, -1:]], dim=1)


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
