"""Penetrate, float, skate and their sum: PhysDiff (Yuan et al., ICCV 2023), section 4.

PhysDiff takes the lowest vertex of the body mesh and tolerates 5 mm; a depth past the tolerance
counts in full. Here the lowest point is that of the body's solids, and the points that skate are
those of the soles. Everything is in millimetres a frame at the rate of the motion; the report
takes the mean over all frames at 20 fps.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.geometry import body_probes, sole_probes

TOLERANCE = 0.005
"""Distances from the floor up to this [m] are no error."""


@dataclass(frozen=True, eq=False)
class GroundErrors:
    """Errors of each frame.

    Attributes:
        lowest: Height of the lowest point of the body [T], m; negative below the floor.
        penetrate: [T], mm.
        float_: [T], mm.
        skate: Mean horizontal displacement to the next frame of the sole's corners that touch in
            both [T], mm; the last frame's is 0.
    """

    lowest: Array = field(repr=False)
    penetrate: Array = field(repr=False)
    float_: Array = field(repr=False)
    skate: Array = field(repr=False)

    @property
    def phys_err(self) -> Array:
        """The sum of the three [T], mm."""
        return self.penetrate + self.float_ + self.skate


def ground_errors(motion: Motion) -> GroundErrors:
    """Measure a motion against a floor at z = 0."""
    lowest = body_probes().heights(motion).min(axis=1)
    soles = np.concatenate([sole_probes(side).centres(motion) for side in ("left", "right")], 1)
    return ground_errors_of(lowest, soles)


def ground_errors_of(lowest: Array, soles: Array) -> GroundErrors:
    """Measure any body.

    Args:
        lowest: Height of its lowest point [T], m.
        soles: Points of all soles [T, C, 3], m.
    """
    touching = soles[..., 2] < TOLERANCE
    both = touching[1:] & touching[:-1]
    moved = np.linalg.norm(np.diff(soles[..., :2], axis=0), axis=-1)
    skate = np.sum(moved * both, axis=1) / np.maximum(both.sum(axis=1), 1)
    return GroundErrors(
        lowest=lowest,
        penetrate=1000.0 * np.where(lowest < -TOLERANCE, -lowest, 0.0),
        float_=1000.0 * np.where(lowest > TOLERANCE, lowest, 0.0),
        skate=1000.0 * np.append(skate, 0.0),
    )
