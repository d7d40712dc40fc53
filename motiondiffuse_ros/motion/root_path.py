"""Bend the root's path of a pose state through given places, in torch, for use while denoising."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from scipy.interpolate import CubicSpline
from torch import Tensor

from motiondiffuse_ros.motion.features import PoseState


@dataclass(frozen=True)
class PathPoint:
    """Where the root has to be at one frame.

    The frame is REP-103's: the motion starts over the origin, facing +x, y is to the left.

    Attributes:
        frame: Above 0.
        x: m.
        y: m.
        heading: About the vertical, rad; None is free.
    """

    frame: int
    x: float
    y: float
    heading: float | None = None


class RootPath:
    """Moves the path of the root, as little as it can be seen, through points.

    What is added to heading and place over time are natural cubic splines through what is missing
    at the points, so that speeds change smoothly; velocities of all joints follow.
    """

    def __init__(self, points: Sequence[PathPoint], frames: int, fps: float) -> None:
        """Lay out the splines.

        Args:
            points: In order of time, frames from 1 to `frames` - 1.
            frames: Length of the motion.
            fps: Frame rate, Hz.
        """
        groups = PoseState().groups()
        self._yaw, self._planar = groups["yaw_velocity"], groups["root_velocity"]
        self._positions, self._velocities = groups["positions"], groups["velocities"]
        self._fps = fps
        turned = [p for p in points if p.heading is not None]
        self._headings = torch.tensor([p.heading for p in turned], dtype=torch.float32)
        # the y-up frame of the features: x to the left, z ahead
        self._places = torch.tensor([(p.y, p.x) for p in points], dtype=torch.float32)
        self._turn_frames = torch.tensor([p.frame for p in turned], dtype=torch.long)
        self._place_frames = torch.tensor([p.frame for p in points], dtype=torch.long)
        self._turn_basis = _spline_basis([p.frame for p in turned], frames)
        self._place_basis = _spline_basis([p.frame for p in points], frames)

    def __call__(self, features: Tensor) -> Tensor:
        """Return pose states [C, T, 269], denormalised, whose decoded root meets the points."""
        features = features.clone()
        yaw_rate = features[..., self._yaw.start]  # a view: it follows what is added
        if len(self._headings):
            missing = self._headings - self._integrate(yaw_rate)[:, self._turn_frames]
            added = self._rate(_nearest_turns(missing) @ self._turn_basis.T)
            yaw_rate += added
            self._swing_joints(features, added)
        yaw = self._integrate(yaw_rate)
        sine, cosine = yaw.sin(), yaw.cos()
        left, ahead = features[..., self._planar].unbind(-1)
        world = torch.stack([cosine * left + sine * ahead, cosine * ahead - sine * left], dim=-1)
        path = self._integrate(world.transpose(1, 2)).transpose(1, 2)
        missing = self._places - path[:, self._place_frames]
        added = self._rate((self._place_basis @ missing).transpose(1, 2)).transpose(1, 2)
        x, z = added.unbind(-1)
        left, ahead = cosine * x - sine * z, cosine * z + sine * x
        features[..., self._planar] += torch.stack([left, ahead], dim=-1)
        features[..., self._velocities.start : self._velocities.stop : 3] += left[..., None]
        features[..., self._velocities.start + 2 : self._velocities.stop : 3] += ahead[..., None]
        return features

    def _swing_joints(self, features: Tensor, yaw_rate: Tensor) -> None:
        """Add the velocity that turning gives to joints off the root's axis."""
        below = features[..., self._positions]
        x, z = below[..., 0::3], below[..., 2::3]
        start = self._velocities.start + 3  # the root itself is on its axis
        features[..., start : self._velocities.stop : 3] += yaw_rate[..., None] * z
        features[..., start + 2 : self._velocities.stop : 3] -= yaw_rate[..., None] * x

    def _integrate(self, rate: Tensor) -> Tensor:
        """Return the integral [..., T] of a rate [..., T], from zero, as decoding does."""
        total = torch.cumsum(rate, dim=-1) / self._fps
        return torch.cat([torch.zeros_like(total[..., :1]), total[..., :-1]], dim=-1)

    def _rate(self, values: Tensor) -> Tensor:
        """Undo `_integrate`; the last rate is repeated."""
        step = values.diff(dim=-1) * self._fps
        return torch.cat([step, step[..., -1:]], dim=-1)


def _spline_basis(knots: Sequence[int], frames: int) -> Tensor:
    """Return [frames, K]: natural splines from zero at frame 0, each one at one knot.

    After the last knot the value stays.
    """
    if not knots:
        return torch.zeros(frames, 0)
    values = np.vstack([np.zeros(len(knots)), np.eye(len(knots))])
    spline = CubicSpline([0, *knots], values, bc_type="natural")
    basis = spline(np.minimum(np.arange(frames), knots[-1]))
    return torch.from_numpy(basis.astype(np.float32))


def _nearest_turns(missing: Tensor) -> Tensor:
    """Choose among angles [C, K] that differ by whole turns those nearest to zero and in line."""
    turn = 2.0 * math.pi
    steps = torch.diff(missing, dim=-1, prepend=torch.zeros_like(missing[:, :1]))
    return torch.cumsum(torch.remainder(steps + math.pi, turn) - math.pi, dim=-1)
