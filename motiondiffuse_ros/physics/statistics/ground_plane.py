"""The plane that standing feet lie in, and where over it the body pushes: both are level or centred
in real motion, and lean with a motion that leans as a whole."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.balance import GRAVITY
from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.dynamics import Dynamics
from motiondiffuse_ros.physics.statistics.frames import in_heading, planted

_PRIOR = 0.03  # m, spread of a sole's own length: a slope that only this shows counts half
_LEAST_PUSH = 0.3  # body weights; with less under it the centre of pressure is not known


def ground_plane(motion: Motion, states: BodyStates, dynamics: Dynamics) -> dict[str, float]:
    """Return slopes of the ground under standing feet and offsets of the pressure [m]."""
    rests = [planted(sole, states.fps) for sole in states.soles]
    heading, root = motion.heading, motion.root
    return {
        **_slopes(states.soles, rests, heading, root),
        **_pressure(states, rests, heading, dynamics),
    }


def _slopes(
    soles: Sequence[Array],
    rests: list[NDArray[np.bool_]],
    heading: Array,
    root: Array,
) -> dict[str, float]:
    middles = [sole.mean(axis=1) for sole in soles]
    places = np.concatenate([m[r] for m, r in zip(middles, rests, strict=True)])
    roots = np.concatenate([root[r] for r in rests])
    headings = np.concatenate([heading[r] for r in rests])
    corners = np.concatenate(
        [(s - m[:, None])[r] for s, m, r in zip(soles, middles, rests, strict=True)]
    )
    # a motion that leans about the point under its root leaves heights that rise with the
    # distance from it, whichever way the path goes
    away = places - roots * np.array([1.0, 1.0, 0.0])
    ahead = in_heading(headings, away)
    world, own = _slope(away), _slope(ahead)
    sole = _slope(corners.reshape(-1, 3)) if len(corners) else np.zeros(2)
    both = _slope(np.concatenate([_centred(away), *corners.swapaxes(0, 1)]))
    return {
        "ground_slope": float(np.linalg.norm(world)),
        "ground_slope_ahead": float(own[0]),
        "ground_slope_aside": float(abs(own[1])),
        "ground_slope_of_soles": float(np.linalg.norm(sole)),
        "ground_slope_of_all": float(np.linalg.norm(both)),
        "ground_slope_agreement": float(world @ sole),
        "ground_unevenness": _residual(away, world),
    }


def _slope(points: Array) -> Array:
    """Return the slope of the plane through points [N, 3], drawn to 0 where they are close [2]."""
    if len(points) < 2:
        return np.zeros(2)
    off = _centred(points)
    spread = off[:, :2].T @ off[:, :2] / len(off) + _PRIOR**2 * np.eye(2)
    return np.linalg.solve(spread, off[:, :2].T @ off[:, 2] / len(off))


def _centred(points: Array) -> Array:
    return points - points.mean(axis=0) if len(points) else points


def _residual(points: Array, slope: Array) -> float:
    if len(points) < 2:
        return 0.0
    off = _centred(points)
    return float(np.std(off[:, 2] - off[:, :2] @ slope))


def _pressure(
    states: BodyStates, rests: list[NDArray[np.bool_]], heading: Array, dynamics: Dynamics
) -> dict[str, float]:
    names = ("pressure_ahead", "pressure_aside", "pressure_off", "pressure_off_50")
    centre = dynamics.centre
    acceleration = np.diff(centre, n=2, axis=0) * states.fps**2
    push = acceleration[:, 2] + GRAVITY
    inner = slice(2, len(heading) - 2)
    stands = np.stack([r[inner] for r in rests], axis=1)
    known = stands.any(axis=1) & (push > _LEAST_PUSH * GRAVITY)
    if known.sum() < 2:
        return dict.fromkeys(names, 0.0)
    middles = np.stack([s.mean(axis=1)[inner] for s in states.soles], axis=1)
    under = (middles * stands[..., None])[known].sum(axis=1) / stands[known].sum(axis=1)[:, None]
    height = centre[1:-1, 2][known] - under[:, 2]
    lean = acceleration[known, :2] * (height / push[known])[:, None]
    off = np.zeros((len(under), 3))
    off[:, :2] = centre[1:-1, :2][known] - lean - under[:, :2]
    # one foot carries at a time in walking: medians do not care for what is between
    ahead, aside, _ = np.median(in_heading(heading[inner][known], off), axis=0)
    far = np.linalg.norm(off, axis=1)
    figures = (ahead, abs(aside), np.linalg.norm(np.median(off, axis=0)), np.median(far))
    return dict(zip(names, map(float, figures), strict=True))
