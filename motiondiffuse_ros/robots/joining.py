"""From the state in which a robot is onto the path of a motion, in position, speed and curvature.

The path is extended by a run-in from rest where the gap is too wide to be closed on the way. What
is missing at the start is added to it and dies away along a quintic.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import BPoly, CubicSpline
from scipy.spatial.transform import RotationSpline

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.robots.start_state import RootState, StartState

MERGE = 0.5
"""Least time in which a gap is closed [s]."""

LONGEST_MERGE = 1.5
"""Gaps that need longer are closed before the motion starts [s]."""

WIDE = 0.5
"""Joints [rad] and root [m, rad] farther off than this are brought there before the motion."""

APPROACH_SPEED = 1.5
"""Speed of such an approach, joints and root [rad/s, m/s]."""

RUN_IN = 0.5
"""Of an approach, what is used to gather the motion's first speed [s]."""

_PEAK = 1.875  # greatest speed of a quintic from rest to rest, in parts of its mean speed
_GROWTH = 1.25
_GRID = 0.01
_CLEAR = 0.3  # time at the start within which nothing may be slowed down [s]
_TINY = 1e-3


@dataclass(frozen=True, eq=False)
class Paths:
    """The paths of a motion over path time [s].

    Attributes:
        joints: [J], rad.
        root: [3], m.
        turn: Of the root.
        end: Last path time.
    """

    joints: CubicSpline = field(repr=False)
    root: CubicSpline = field(repr=False)
    turn: RotationSpline = field(repr=False)
    end: float

    def orientation(self, times: Array) -> Array:
        """Return the root's orientation [N, 4], wxyz."""
        return self.turn(times).as_quat(scalar_first=True)


@dataclass(frozen=True, eq=False)
class JoinedPaths:
    """Paths that begin in a given state.

    Attributes:
        approach: Time before the motion's first frame [s].
        merge: Time in which the gap is closed [s].
        end: Last path time, approach included [s].
        joints: Joint positions [N, J] at times [N], or their derivative.
        root: Root position [N, 3], or its derivative.
        orientation: Root orientation [N, 4], wxyz.
    """

    approach: float
    merge: float
    end: float
    joints: Callable[..., Array] = field(repr=False)
    root: Callable[..., Array] = field(repr=False)
    orientation: Callable[[Array], Array] = field(repr=False)


def join(paths: Paths, start: StartState, limits: Array, stop_window: float) -> JoinedPaths:
    """Lead from a state onto paths.

    Args:
        paths: Of the motion.
        start: Within the position and velocity limits.
        limits: Largest joint speeds [J], rad/s.
        stop_window: Time at the end in which the gap has to be closed [s].
    """
    gap = _gap(paths, start)
    longest = min(LONGEST_MERGE, paths.end - stop_window)
    merge = MERGE
    while gap <= WIDE and merge <= longest:
        joined = _joined(paths, start, 0.0, merge)
        if _fast(joined, merge + _CLEAR, limits) <= 1.0:
            return joined
        merge *= _GROWTH
    approach = max(RUN_IN, _PEAK * gap / APPROACH_SPEED)
    for _ in range(8):
        joined = _joined(paths, start, approach, approach)
        if _fast(joined, _CLEAR, limits) <= 1.0:
            break
        approach *= _GROWTH
    return joined


def _fast(joined: JoinedPaths, until: float, limits: Array) -> float:
    """Return the greatest joint speed up to a time, in parts of its limit."""
    times = np.arange(0.0, min(until, joined.end), _GRID)
    return float((np.abs(joined.joints(times, 1)) / limits).max(initial=0.0))


def _gap(paths: Paths, start: StartState) -> float:
    gap = float(np.abs(start.positions - paths.joints(0.0)).max(initial=0.0))
    if start.root is None:
        return gap
    away = float(np.linalg.norm(start.root.position - paths.root(0.0)))
    first = paths.orientation(np.zeros(1))
    return max(gap, away, float(rot.angle_between(first, start.root.orientation[None])[0]))


def _joined(paths: Paths, start: StartState, approach: float, merge: float) -> JoinedPaths:
    joints, root = _extended(paths.joints, approach), _extended(paths.root, approach)
    turn = _extended_turn(paths, approach)
    orientation = turn
    if start.root is not None:
        state = start.root
        root = _offset(root, state.position, state.linear_velocity, merge)
        orientation = _offset_turn(turn, state, merge)
    return JoinedPaths(
        approach=approach,
        merge=merge,
        end=approach + paths.end,
        joints=_offset(joints, start.positions, start.velocities, merge),
        root=root,
        orientation=orientation,
    )


def _extended(path: CubicSpline, approach: float) -> Callable[..., Array]:
    """Hold the first point before a path, then run in from rest to its speed and curvature."""
    if approach == 0.0:
        return path
    first, speed, curvature = (path(0.0, n) for n in range(3))
    still = np.zeros_like(first)
    run_in = BPoly.from_derivatives(
        [0.0, RUN_IN], [[first, still, still], [first, speed, curvature]]
    )

    def extended(times: Array | float, derivative: int = 0) -> Array:
        times = np.asarray(times, dtype=float)
        early = run_in(np.clip(times - approach + RUN_IN, 0.0, RUN_IN), derivative)
        late = path(np.maximum(times - approach, 0.0), derivative)
        return np.where(times[..., None] < approach, early, late)

    return extended


def _extended_turn(paths: Paths, approach: float) -> Callable[[Array], Array]:
    if approach == 0.0:
        return paths.orientation
    first = paths.orientation(np.zeros(1))
    spin, still = _spin(paths.orientation), np.zeros(3)
    run_in = BPoly.from_derivatives([0.0, RUN_IN], [[still, still, still], [still, spin, still]])

    def extended(times: Array) -> Array:
        turned = rot.from_rotation_vector(run_in(np.clip(times - approach + RUN_IN, 0.0, RUN_IN)))
        late = paths.orientation(np.maximum(times - approach, 0.0))
        return np.where(times[:, None] < approach, rot.multiply(turned, first), late)

    return extended


def _offset(
    path: Callable[..., Array], value: Array, speed: Array, merge: float
) -> Callable[..., Array]:
    """Add what is missing at the start to a path; it dies away in `merge` seconds."""
    missing, still = value - path(0.0), np.zeros_like(value)
    fading = BPoly.from_derivatives(
        [0.0, merge], [[missing, speed - path(0.0, 1), still], [still, still, still]]
    )

    def joined(times: Array | float, derivative: int = 0) -> Array:
        times = np.asarray(times, dtype=float)
        added = fading(np.minimum(times, merge), derivative)
        return path(times, derivative) + np.where(times[..., None] < merge, added, 0.0)

    return joined


def _offset_turn(
    path: Callable[[Array], Array], state: RootState, merge: float
) -> Callable[[Array], Array]:
    first = path(np.zeros(1))[0]
    missing = rot.to_rotation_vector(rot.multiply(state.orientation, rot.conjugate(first)))
    spin = state.angular_velocity - rot.rotate(rot.from_rotation_vector(missing), _spin(path))
    still = np.zeros(3)
    fading = BPoly.from_derivatives(
        [0.0, merge],
        [[missing, np.linalg.solve(_left_jacobian(missing), spin), still], [still, still, still]],
    )

    def joined(times: Array) -> Array:
        added = fading(np.minimum(times, merge)) * (times[:, None] < merge)
        return rot.multiply(rot.from_rotation_vector(added), path(times))

    return joined


def _spin(path: Callable[[Array], Array]) -> Array:
    """Return the world angular velocity [3] at the start, rad/s."""
    before, after = path(np.array([0.0, _TINY]))
    return rot.to_rotation_vector(rot.multiply(after, rot.conjugate(before))) / _TINY


def _left_jacobian(v: Array) -> Array:
    """Return [3, 3]: from the rate of a rotation vector to the world angular velocity."""
    angle = float(np.linalg.norm(v))
    x, y, z = v
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    if angle < 1e-6:
        return np.eye(3) + 0.5 * cross
    return (
        np.eye(3)
        + (1.0 - np.cos(angle)) / angle**2 * cross
        + (angle - np.sin(angle)) / angle**3 * cross @ cross
    )
