"""The humanoid's solids: which shapes hang on which joint, and what they weigh.

Masses are the segment fractions of de Leva 1996 (men) of 70 kg. Capsules for the body, boxes for
the feet, whose sole is `ANKLE_HEIGHT` below the ankle and `TOE_HEIGHT` below the toe joint.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from itertools import product

import numpy as np

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import ANKLE_HEIGHT, HEEL_BEHIND_ANKLE, TOE_HEIGHT

_Point = tuple[float, float, float]

_HALF_SOLE = 0.042
# shorter than a person's: mocap toes bend little, and longer ones dip into the floor at push-off
_TOES = 0.05


@dataclass(frozen=True)
class Solid:
    """A capsule between two points, or a box between two corners, in the joint's frame.

    Attributes:
        joint: Canonical joint that carries it.
        start: End of the capsule's axis or lowest corner of the box, m.
        end: Other end or highest corner, m.
        radius: Of the capsule; 0 for a box, m.
        mass: kg.
    """

    joint: str
    start: _Point
    end: _Point
    radius: float
    mass: float

    @property
    def is_box(self) -> bool:
        """Whether it is a box."""
        return self.radius == 0.0


_MIDDLE = (
    Solid("pelvis", (0, -0.07, -0.03), (0, 0.07, -0.03), 0.09, 7.82),
    Solid("spine1", (0, -0.05, 0.06), (0, 0.05, 0.06), 0.10, 5.71),
    Solid("spine2", (0, -0.05, 0.03), (0, 0.05, 0.03), 0.10, 5.72),
    Solid("spine3", (0, -0.07, 0.09), (0, 0.07, 0.09), 0.10, 8.77),
    Solid("neck", (0, 0, 0.01), (0.03, 0, 0.09), 0.05, 1.0),
    Solid("head", (0.02, 0, 0.05), (0.02, 0, 0.11), 0.09, 3.86),
)
_LEFT = (
    Solid("hip", (0, 0, -0.05), (0, 0, -0.37), 0.07, 9.91),
    Solid("knee", (0, 0, -0.03), (0, 0, -0.36), 0.05, 3.03),
    Solid(
        "ankle",
        (-HEEL_BEHIND_ANKLE, -_HALF_SOLE, -ANKLE_HEIGHT),
        (0.13, _HALF_SOLE, -0.03),
        0.0,
        0.76,
    ),
    Solid("foot", (0, -_HALF_SOLE, -TOE_HEIGHT), (_TOES, _HALF_SOLE, 0.01), 0.0, 0.20),
    Solid("collar", (0, 0.02, 0), (0, 0.09, 0.01), 0.05, 1.20),
    Solid("shoulder", (0, 0.02, 0), (0, 0.25, 0), 0.045, 1.90),
    Solid("elbow", (0, 0.02, 0), (0, 0.23, 0), 0.035, 1.13),
    Solid("wrist", (0, 0.02, 0), (0, 0.14, 0), 0.03, 0.43),
)


def _sided(solid: Solid, side: str) -> Solid:
    (x0, y0, z0), (x1, y1, z1) = solid.start, solid.end
    if side == "right":
        # a box keeps its lowest corner lowest
        y0, y1 = (-y1, -y0) if solid.is_box else (-y0, -y1)
    return Solid(f"{side}_{solid.joint}", (x0, y0, z0), (x1, y1, z1), solid.radius, solid.mass)


SOLIDS = (*_MIDDLE, *(_sided(solid, side) for side in ("left", "right") for solid in _LEFT))


@dataclass(frozen=True, eq=False)
class Probes:
    """Spheres that bound the solids from below: capsule ends, and box corners of radius 0.

    Attributes:
        joints: Canonical joint of each probe [P].
        offsets: Centre in the joint's frame [P, 3], m.
        radii: [P], m.
    """

    joints: tuple[int, ...]
    offsets: Array = field(repr=False)
    radii: Array = field(repr=False)

    def centres(self, motion: Motion) -> Array:
        """Return the world centres over time [T, P, 3], m."""
        joints = list(self.joints)
        turned = rot.rotate(motion.global_rotations[:, joints], self.offsets)
        return motion.positions[:, joints] + turned

    def heights(self, motion: Motion) -> Array:
        """Return the height of the lowest point of each probe [T, P], m."""
        return self.centres(motion)[..., 2] - self.radii


@cache
def body_probes() -> Probes:
    """Return the probes of the whole body."""
    return _probes(SOLIDS)


@cache
def sole_probes(side: str) -> Probes:
    """Return the corners of the sole of the "left" or "right" foot."""
    feet = (f"{side}_ankle", f"{side}_foot")
    probes = _probes(tuple(solid for solid in SOLIDS if solid.joint in feet))
    heel = CANONICAL.index(feet[0])
    sole = [
        n
        for n, (joint, offset) in enumerate(zip(probes.joints, probes.offsets, strict=True))
        if np.isclose(offset[2], -ANKLE_HEIGHT if joint == heel else -TOE_HEIGHT)
    ]
    return Probes(tuple(probes.joints[n] for n in sole), probes.offsets[sole], probes.radii[sole])


def _probes(solids: tuple[Solid, ...]) -> Probes:
    joints: list[int] = []
    offsets: list[Array] = []
    for solid in solids:
        ends = np.array([solid.start, solid.end])
        if solid.is_box:
            points = np.take_along_axis(ends, np.array(list(product((0, 1), repeat=3))), axis=0)
        else:
            points = ends
        joints += [CANONICAL.index(solid.joint)] * len(points)
        offsets.append(points)
    radii = np.concatenate(
        [np.full(len(points), solid.radius) for solid, points in zip(solids, offsets, strict=True)]
    )
    return Probes(tuple(joints), np.concatenate(offsets), radii)
