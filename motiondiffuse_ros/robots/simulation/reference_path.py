"""Where a followed trajectory wants the robot at any time, from the pose it has at the start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import BPoly, CubicHermiteSpline, make_interp_spline
from scipy.spatial.transform import Rotation, Slerp

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.robots.trajectory import JointTrajectory


@dataclass(frozen=True, eq=False)
class Reference:
    """The state asked for at one time.

    Attributes:
        positions: Joints [J], rad.
        velocities: Joints [J], rad/s.
        root_position: [3], m.
        root_orientation: [4], wxyz.
        root_linear_velocity: World frame [3], m/s.
        root_angular_velocity: World frame [3], rad/s.
    """

    positions: Array
    velocities: Array
    root_position: Array
    root_orientation: Array
    root_linear_velocity: Array
    root_angular_velocity: Array

    def qpos(self) -> Array:
        """Return it in MuJoCo's order [7 + J]."""
        return np.concatenate([self.root_position, self.root_orientation, self.positions])


@dataclass(frozen=True, eq=False)
class ReferencePath:
    """An approach from the present pose, a trajectory, and its last pose held for ever.

    Attributes:
        duration: Of approach and trajectory [s].
        approach_s: Of the approach [s].
        at: The reference at a time from the start of the approach [s].
    """

    duration: float
    approach_s: float
    at: Callable[[float], Reference]

    @classmethod
    def hold(cls, qpos: Array) -> ReferencePath:
        """Stay where the robot is [7 + J]."""
        zero = np.zeros(3)
        still = Reference(
            qpos[7:].copy(), 0.0 * qpos[7:], qpos[:3].copy(), qpos[3:7].copy(), zero, zero
        )
        return cls(0.0, 0.0, lambda elapsed: still)

    @classmethod
    def approach_and_follow(
        cls, qpos: Array, trajectory: JointTrajectory, approach_s: float
    ) -> ReferencePath:
        """Join the present pose to a trajectory.

        Args:
            qpos: Present state [7 + J].
            trajectory: Joints in the order of `qpos`.
            approach_s: Time for the approach [s], above 0.
        """
        moved = _anchored(trajectory, qpos)
        end = approach_s + moved.duration
        times = approach_s + moved.times
        joints = _Spline(approach_s, qpos[7:], times, moved.positions, moved.velocities)
        root = _Spline(approach_s, qpos[:3], times, moved.root_position, moved.root_linear_velocity)
        knots = np.concatenate([[0.0], times])
        spin = make_interp_spline(knots, np.vstack([np.zeros(3), moved.root_angular_velocity]), k=1)
        turn = Slerp(
            knots,
            Rotation.from_quat(np.vstack([qpos[3:7], moved.root_orientation]), scalar_first=True),
        )

        def at(elapsed: float) -> Reference:
            t = float(np.clip(elapsed, 0.0, end))
            # rest to rest in the approach
            eased = approach_s * _smooth_step(t / approach_s) if t < approach_s else t
            moving = 1.0 if elapsed < end else 0.0
            return Reference(
                positions=joints(t),
                velocities=moving * joints(t, 1),
                root_position=root(t),
                root_orientation=turn(eased).as_quat(scalar_first=True),
                root_linear_velocity=moving * root(t, 1),
                root_angular_velocity=spin(t),
            )

        return cls(end, approach_s, at)


class _Spline:
    """A quintic from a standing start to the first point, then cubics through all points."""

    def __init__(
        self, approach_s: float, start: Array, times: Array, values: Array, slopes: Array
    ) -> None:
        still = np.zeros_like(start)
        self._split = approach_s
        self._approach = BPoly.from_derivatives(
            [0.0, approach_s], [[start, still, still], [values[0], slopes[0], still]]
        )
        self._follow = CubicHermiteSpline(times, values, slopes)

    def __call__(self, t: float, derivative: int = 0) -> Array:
        piece = self._approach if t < self._split else self._follow
        return piece(t, derivative)


def _anchored(trajectory: JointTrajectory, qpos: Array) -> JointTrajectory:
    """Move the root path on the ground plane to the robot's place and heading."""
    first = trajectory.root_orientation[0]
    turn = rot.about_axis(2, rot.twist_angle(qpos[3:7], axis=2) - rot.twist_angle(first, axis=2))
    level = np.array([1.0, 1.0, 0.0])
    path = rot.rotate(turn, trajectory.root_position - trajectory.root_position[0] * level)
    return replace(
        trajectory,
        root_position=path + qpos[:3] * level,
        root_orientation=rot.multiply(turn, trajectory.root_orientation),
        root_linear_velocity=rot.rotate(turn, trajectory.root_linear_velocity),
        root_angular_velocity=rot.rotate(turn, trajectory.root_angular_velocity),
    )


def _smooth_step(s: float) -> float:
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
