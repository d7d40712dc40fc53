"""Quaternion arithmetic on numpy arrays, scalar first (wxyz) as MuJoCo has it.

All functions broadcast over leading axes: quaternions are [..., 4], vectors [..., 3].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.floating[Any]]
Indices = NDArray[np.intp]


def identity(*shape: int) -> Array:
    """Return unit quaternions of shape [*shape, 4]."""
    out = np.zeros((*shape, 4))
    out[..., 0] = 1.0
    return out


def multiply(a: Array, b: Array) -> Array:
    """Return the Hamilton product a * b (apply b first, then a)."""
    aw, ax, ay, az = _parts(np.asarray(a, dtype=np.float64))
    bw, bx, by, bz = _parts(np.asarray(b, dtype=np.float64))
    return _joined(
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def cross(a: Array, b: Array) -> Array:
    """Return the cross product of vectors; numpy's own takes far longer than its arithmetic."""
    (ax, ay, az), (bx, by, bz) = _parts(a), _parts(b)
    return _joined(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)


def _parts(a: Array) -> list[Array]:
    # numpy's moveaxis and stack cost as much as the arithmetic on a few hundred frames
    return [a[..., i] for i in range(a.shape[-1])]


def _joined(*parts: Array) -> Array:
    out = np.empty((*parts[0].shape, len(parts)))
    for i, part in enumerate(parts):
        out[..., i] = part
    return out


def conjugate(q: Array) -> Array:
    """Return the inverse of unit quaternions."""
    return np.asarray(q) * np.array([1.0, -1.0, -1.0, -1.0])


def rotate(q: Array, v: Array) -> Array:
    """Rotate vectors v [..., 3] by unit quaternions q [..., 4]."""
    w, u = q[..., :1], q[..., 1:]
    t = 2.0 * cross(u, v)
    return v + w * t + cross(u, t)


def normalise(q: Array) -> Array:
    """Scale quaternions to unit length."""
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def continuous(q: Array) -> Array:
    """Flip signs along the first axis so that neighbours lie on the same hemisphere."""
    dots = np.sum(q[1:] * q[:-1], axis=-1)
    signs = np.cumprod(np.where(dots < 0.0, -1.0, 1.0), axis=0)
    return np.concatenate([q[:1], q[1:] * signs[..., None]])


def from_matrix(m: Array) -> Array:
    """Convert rotation matrices [..., 3, 3] to quaternions."""
    flat = Rotation.from_matrix(np.reshape(m, (-1, 3, 3))).as_quat(scalar_first=True)
    return flat.reshape(*m.shape[:-2], 4)


def to_matrix(q: Array) -> Array:
    """Convert quaternions to rotation matrices [..., 3, 3]."""
    w, x, y, z = _parts(np.asarray(q, dtype=np.float64))
    return _joined(
        1 - 2 * (y * y + z * z),
        2 * (x * y - w * z),
        2 * (x * z + w * y),
        2 * (x * y + w * z),
        1 - 2 * (x * x + z * z),
        2 * (y * z - w * x),
        2 * (x * z - w * y),
        2 * (y * z + w * x),
        1 - 2 * (x * x + y * y),
    ).reshape(*w.shape, 3, 3)


def to_columns(q: Array) -> Array:
    """Convert quaternions to the first two columns of their matrices, [..., 6]."""
    return np.swapaxes(to_matrix(q)[..., :2], -1, -2).reshape(*np.shape(q)[:-1], 6)


def from_columns(columns: Array) -> Array:
    """Undo `to_columns`: the nearest rotation by Gram-Schmidt (Zhou et al. 2019).

    Columns [..., 6] that were sampled may vanish; any direction is then as good.
    """
    a, b = columns[..., :3], columns[..., 3:]
    x = unit(a)
    y = unit(b - np.sum(x * b, axis=-1, keepdims=True) * x)
    return from_matrix(np.stack([x, y, cross(x, y)], axis=-1))


def from_rotation_vector(v: Array) -> Array:
    """Convert rotation vectors (axis times angle, rad) to quaternions."""
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    # sinc is sin(pi x)/(pi x), finite at zero where v / angle is not
    return np.concatenate([np.cos(angle / 2), v * 0.5 * np.sinc(angle / (2 * np.pi))], axis=-1)


def to_rotation_vector(q: Array) -> Array:
    """Convert quaternions to rotation vectors of at most pi rad."""
    q = np.where(q[..., :1] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., :1])
    scale = np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 1e-12)
    return q[..., 1:] * scale


def angle_between(a: Array, b: Array) -> Array:
    """Return the angle [rad] of the rotation from a to b."""
    return np.linalg.norm(to_rotation_vector(multiply(conjugate(a), b)), axis=-1)


def about_axis(axis: int, angle: Array) -> Array:
    """Return rotations by angle [rad] about the coordinate axis 0 (x), 1 (y) or 2 (z)."""
    angle = np.asarray(angle, dtype=np.float64)
    out = np.zeros((*angle.shape, 4))
    out[..., 0] = np.cos(angle / 2)
    out[..., 1 + axis] = np.sin(angle / 2)
    return out


def twist_angle(q: Array, axis: int) -> Array:
    """Return the angle [rad, -pi to pi] of the twist of q about a coordinate axis.

    q = twist * swing with the swing's axis perpendicular to the coordinate axis; undefined only
    where the rotation turns the axis upside down.
    """
    angle = 2.0 * np.arctan2(q[..., 1 + axis], q[..., 0])
    return (angle + np.pi) % (2 * np.pi) - np.pi


def shortest_arc(a: Array, b: Array) -> Array:
    """Return the smallest rotation that takes direction a to direction b.

    Half a turn about some perpendicular axis where they are opposite; none where one is zero.
    """
    a, b = np.broadcast_arrays(unit(a), unit(b))
    w = 1.0 + np.sum(a * b, axis=-1, keepdims=True)
    opposite = w < 1e-9
    perpendicular = np.cross(a, np.eye(3)[np.argmin(np.abs(a), axis=-1)])
    axis = np.where(opposite, perpendicular, np.cross(a, b))
    return normalise(np.concatenate([np.where(opposite, 0.0, w), axis], axis=-1))


def unit(v: Array) -> Array:
    """Scale vectors [..., 3] to unit length; one that vanishes stays what it is."""
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-8)


def slerp(a: Array, b: Array, t: float | Array) -> Array:
    """Interpolate along the shortest arc: a at t = 0, b at t = 1."""
    step = to_rotation_vector(multiply(conjugate(a), b))
    return multiply(a, from_rotation_vector(step * np.asarray(t)[..., None]))


def angular_velocity(q: Array, fps: float) -> Array:
    """Return world-frame angular velocities [T, ..., 3] in rad/s by central differences.

    Args:
        q: Rotations over time [T, ..., 4], T at least 2.
        fps: Frames per second.
    """
    forward = to_rotation_vector(multiply(q[1:], conjugate(q[:-1]))) * fps
    return np.concatenate([forward[:1], 0.5 * (forward[1:] + forward[:-1]), forward[-1:]])
