"""How much feet slide on the floor.

The skating ratio is that of GMD (Karunratanakul et al., ICCV 2023): the share of frames at 20 fps
in which a foot joint is below 5 cm in this and the next frame and moves horizontally faster than
0.5 m/s, both now and averaged over 5 frames. The contact-only form divides by the frames in which
a foot is that low at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.physics.geometry import sole_probes

GMD_HEIGHT, GMD_SPEED, GMD_WINDOW = 0.05, 0.5, 5

CONTACT_HEIGHT = 0.025
"""A corner of a sole below this [m] in two frames may carry the body."""


@dataclass(frozen=True, eq=False)
class Skating:
    """Foot sliding between each frame and the next; index 0 of the second axis is the left foot.

    Attributes:
        low: GMD's contact [T - 1, 2].
        skating: GMD's sliding [T - 1, 2].
        slide_speed: Speed of the sole's corner that moves least among those in contact
            [T - 1, 2], m/s; NaN where the foot is in the air. A foot that rolls or pivots has
            such a corner at rest, one that slides has none.
    """

    low: NDArray[np.bool_] = field(repr=False)
    skating: NDArray[np.bool_] = field(repr=False)
    slide_speed: Array = field(repr=False)

    @property
    def ratio(self) -> float:
        """Share of frames in which a foot skates."""
        return float(self.skating.any(axis=1).mean()) if len(self.skating) else 0.0

    @property
    def contact_ratio(self) -> float:
        """Share of the frames with a foot on the floor in which a foot skates."""
        grounded = self.low.any(axis=1).sum()
        return float(self.skating.any(axis=1).sum() / grounded) if grounded else 0.0

    @property
    def support_slide(self) -> Array:
        """Speed of the corner of either foot that moves least [T - 1], m/s; 0 in flight."""
        return np.nan_to_num(np.fmin.reduce(self.slide_speed, axis=1))


def foot_skating(motion: Motion) -> Skating:
    """Measure a motion at its own rate; GMD's figures suppose 20 fps."""
    feet = motion.positions[:, [CANONICAL.index(f"{side}_foot") for side in SIDES]]
    return skating_of(feet, [sole_probes(side).centres(motion) for side in SIDES], motion.fps)


def skating_of(feet: Array, soles: Sequence[Array], fps: float) -> Skating:
    """Measure any body with F feet, whose number takes the place of 2 in the shapes above.

    Args:
        feet: A point of each foot [T, F, 3], m, lower than `GMD_HEIGHT` where the foot stands.
        soles: Points of each sole [T, C, 3], m.
        fps: Frames per second.
    """
    low = (feet[1:, :, 2] < GMD_HEIGHT) & (feet[:-1, :, 2] < GMD_HEIGHT)
    speed = np.linalg.norm(np.diff(feet[..., :2], axis=0), axis=-1) * fps
    smoothed = uniform_filter1d(speed, GMD_WINDOW, axis=0, mode="constant") if len(speed) else speed
    return Skating(
        low=low,
        skating=low & (speed > GMD_SPEED) & (smoothed > GMD_SPEED),
        slide_speed=np.stack([_slide_speed(corners, fps) for corners in soles], axis=1),
    )


def _slide_speed(corners: Array, fps: float) -> Array:
    touching = corners[..., 2] < CONTACT_HEIGHT
    both = touching[1:] & touching[:-1]
    speed = np.linalg.norm(np.diff(corners[..., :2], axis=0), axis=-1) * fps
    slowest = np.min(speed, axis=1, where=both, initial=np.inf)
    return np.where(both.any(axis=1), slowest, np.nan)
