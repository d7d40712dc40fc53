"""The state in which a robot is when a trajectory begins."""

from __future__ import annotations

from dataclasses import dataclass, field

from motiondiffuse_ros.motion.rotations import Array


@dataclass(frozen=True, eq=False)
class RootState:
    """Pose and twist of the floating base, in the world.

    Attributes:
        position: [3], m.
        orientation: [4], wxyz.
        linear_velocity: [3], m/s.
        angular_velocity: World frame [3], rad/s.
    """

    position: Array = field(repr=False)
    orientation: Array = field(repr=False)
    linear_velocity: Array = field(repr=False)
    angular_velocity: Array = field(repr=False)


@dataclass(frozen=True, eq=False)
class StartState:
    """Joints, and the floating base where it is known.

    Attributes:
        positions: Joints [J], rad.
        velocities: Joints [J], rad/s.
        root: None leaves the base on the motion's path.
    """

    positions: Array = field(repr=False)
    velocities: Array = field(repr=False)
    root: RootState | None = None
