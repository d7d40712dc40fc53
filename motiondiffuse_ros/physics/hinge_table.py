"""The humanoid's 63 hinges: order of axes, ranges, speeds, torques and gains of every joint.

Ranges and speeds start from the quantiles of real clips of both training sets (0.05 and 99.95 %),
with a margin, and are cut where a human joint ends. The order of axes was chosen among the six for
how far the middle axis stays from 90 degrees in those clips, where hinges lock and angles jump;
`benchmarks/humanoid_hinges.py` prints both.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.motion.rotations import Array

_Degrees = tuple[float, float]


@dataclass(frozen=True)
class JointHinges:
    """Three hinges of one joint of the left side or the middle of the body.

    Attributes:
        order: Axes from the parent's side to the child's.
        x: Range about x [degrees]; likewise y and z.
        y: See x.
        z: See x.
        speed: Limit of each hinge's speed, rad/s.
        torque: Limit of each hinge's torque, N m.
        stiffness: Position gain of the PD controller, N m/rad.
        armature: Rotor-like inertia that keeps light links stable, kg m^2.
        tilt: Rotation about x [degrees] from the T-pose to the pose in which the hinges are zero.
    """

    order: str
    x: _Degrees
    y: _Degrees
    z: _Degrees
    speed: float
    torque: float
    stiffness: float
    armature: float = 0.01
    tilt: float = 0.0

    def ranges(self) -> tuple[_Degrees, ...]:
        """Return the ranges in the order of the hinges [degrees]."""
        by_axis = {"x": self.x, "y": self.y, "z": self.z}
        return tuple(by_axis[axis] for axis in self.order)


_LEFT_AND_MIDDLE = {
    "hip": JointHinges("yxz", (-45, 65), (-150, 45), (-70, 80), 25, 300, 2000, 0.02),
    "knee": JointHinges("yxz", (-10, 10), (-5, 160), (-25, 25), 25, 300, 2000, 0.02),
    "ankle": JointHinges("zxy", (-35, 35), (-75, 50), (-45, 65), 30, 250, 1600, 0.02),
    "foot": JointHinges("yxz", (-10, 10), (-60, 45), (-10, 10), 20, 80, 240),
    "spine1": JointHinges("yxz", (-35, 35), (-50, 80), (-45, 45), 15, 300, 2400, 0.02),
    "spine2": JointHinges("yxz", (-20, 20), (-25, 25), (-20, 20), 15, 300, 2400, 0.02),
    "spine3": JointHinges("yxz", (-20, 20), (-25, 25), (-20, 20), 15, 300, 2400, 0.02),
    "neck": JointHinges("yxz", (-40, 40), (-55, 60), (-45, 45), 15, 80, 400),
    "head": JointHinges("xzy", (-65, 90), (-90, 65), (-55, 55), 20, 60, 320),
    "collar": JointHinges("zyx", (-25, 30), (-15, 15), (-25, 40), 10, 150, 1200),
    # zero is the A-pose: from there the middle axis has the most room (see docs/physics.md)
    "shoulder": JointHinges("yxz", (-75, 85), (-150, 110), (-140, 100), 25, 150, 800, tilt=-45.0),
    "elbow": JointHinges("zxy", (-50, 45), (-85, 80), (-170, 35), 25, 100, 600),
    "wrist": JointHinges("yzx", (-35, 75), (-110, 90), (-40, 45), 30, 40, 120, 0.005),
}


@dataclass(frozen=True, eq=False)
class HingeTable:
    """The same for all hinges at once, in the order of `qpos[7:]`; K = 63.

    Attributes:
        names: `left_hip_y` and so on [K].
        joints: Index of the canonical joint of each three hinges [K / 3].
        orders: Order of axes of each joint [K / 3].
        tilts: Rotation about x from the T-pose to zero hinges [K / 3], rad.
        lower: Lower end of the range [K], rad.
        upper: Upper end [K], rad.
        velocity_limits: Largest speeds [K], rad/s.
        torque_limits: Largest torques [K], N m.
        stiffness: PD position gain [K], N m/rad.
        armature: Added inertia [K], kg m^2.
    """

    names: tuple[str, ...]
    joints: tuple[int, ...]
    orders: tuple[str, ...]
    tilts: Array = field(repr=False)
    lower: Array = field(repr=False)
    upper: Array = field(repr=False)
    velocity_limits: Array = field(repr=False)
    torque_limits: Array = field(repr=False)
    stiffness: Array = field(repr=False)
    armature: Array = field(repr=False)


def _mirror(hinges: JointHinges) -> JointHinges:
    """A reflection across the x-z plane turns the sense of x and z."""
    flip = {"x": (-hinges.x[1], -hinges.x[0]), "z": (-hinges.z[1], -hinges.z[0])}
    return JointHinges(
        hinges.order,
        y=hinges.y,
        **flip,
        speed=hinges.speed,
        torque=hinges.torque,
        stiffness=hinges.stiffness,
        armature=hinges.armature,
        tilt=-hinges.tilt,
    )


def joint_hinges(name: str) -> JointHinges:
    """Return the hinges of a canonical joint other than the pelvis."""
    side, _, part = name.rpartition("_")
    hinges = _LEFT_AND_MIDDLE[part]
    return _mirror(hinges) if side == "right" else hinges


@cache
def hinge_table() -> HingeTable:
    """Return the table of the whole body, joints in depth-first order as MuJoCo numbers them."""
    joints = _depth_first(0)[1:]
    specs = [joint_hinges(CANONICAL.names[j]) for j in joints]
    ranges = np.radians([r for spec in specs for r in spec.ranges()])

    def thrice(values: list[float]) -> Array:
        return np.repeat(np.array(values, dtype=np.float64), 3)

    return HingeTable(
        names=tuple(
            f"{CANONICAL.names[j]}_{axis}"
            for j, spec in zip(joints, specs, strict=True)
            for axis in spec.order
        ),
        joints=tuple(joints),
        orders=tuple(spec.order for spec in specs),
        tilts=np.radians([spec.tilt for spec in specs]),
        lower=ranges[:, 0],
        upper=ranges[:, 1],
        velocity_limits=thrice([spec.speed for spec in specs]),
        torque_limits=thrice([spec.torque for spec in specs]),
        stiffness=thrice([spec.stiffness for spec in specs]),
        armature=thrice([spec.armature for spec in specs]),
    )


def _depth_first(joint: int) -> list[int]:
    children = [j for j, parent in enumerate(CANONICAL.parents) if parent == joint]
    return [joint, *(j for child in children for j in _depth_first(child))]
