"""How the parts of a body work together as it steps: times of swing and stance, arms and legs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.motion.spans import runs
from motiondiffuse_ros.physics.balance import GRAVITY
from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.dynamics import Dynamics
from motiondiffuse_ros.physics.statistics.frames import log_of, median, planted, quantile

_LEG_LENGTH = 0.85
_IN_FLIGHT = 0.04  # m above the lowest place of both soles in the motion
_USUAL_SWING, _USUAL_STANCE = 0.45, 0.7  # s, where no foot shows any
_STILL = 0.02  # m or rad: what moves less has no phase


def gait(motion: Motion, states: BodyStates, dynamics: Dynamics, local: Array) -> dict[str, float]:
    """Return logarithms of times [s] and of dimensionless speeds, and correlations [-1, 1].

    `local` are the joints `from_root`.
    """
    return {
        **_times(states),
        **_flight(states, dynamics),
        **_together(motion, states, local),
        **_reversals(motion, local),
    }


def _times(states: BodyStates) -> dict[str, float]:
    swings: list[float] = []
    stances: list[float] = []
    for sole in states.soles:
        rests = planted(sole, states.fps)
        swings += _inner_lengths(~rests, states.fps)
        stances += _inner_lengths(rests, states.fps)
    path = np.linalg.norm(np.diff(states.qpos[:, :2], axis=0), axis=1).sum()
    speed = path * states.fps / max(len(states.qpos) - 1, 1)
    swing = median(np.array(swings)) if swings else _USUAL_SWING
    stance = median(np.array(stances)) if stances else _USUAL_STANCE
    return {
        "swing_time_50": log_of(swing, 0.05),
        "swing_time_least": log_of(min(swings, default=_USUAL_SWING), 0.05),
        "stance_time_50": log_of(stance, 0.05),
        "swings_per_second": len(swings) * states.fps / len(states.qpos),
        "way_of_a_swing": log_of(float(speed) * swing, 0.05),
        "froude": log_of(float(speed) / np.sqrt(GRAVITY * _LEG_LENGTH), 0.02),
    }


def _inner_lengths(flags: NDArray[np.bool_], fps: float) -> list[float]:
    """Return durations of the runs of True that neither start nor end with the motion [s]."""
    return [(b - a) / fps for a, b in runs(flags) if a > 0 and b < len(flags)]


def _flight(states: BodyStates, dynamics: Dynamics) -> dict[str, float]:
    """Return what a body that touches nothing makes of gravity: its centre falls with 1 g."""
    lowest = np.concatenate(states.soles, axis=1)[..., 2].min(axis=1)
    aloft = lowest > lowest.min() + _IN_FLIGHT
    fall = -np.diff(dynamics.centre[:, 2], n=2) * states.fps**2 / GRAVITY
    # the centre of frame n + 1 is dynamics' n, its second difference between n and n + 2
    inside = aloft[2:-2] & aloft[1:-3] & aloft[3:-1]
    spans = runs(inside)
    off = [float(fall[a:b].mean()) - 1.0 for a, b in spans]
    lengths = [(b - a) / states.fps for a, b in spans]
    longest = int(np.argmax(lengths)) if lengths else 0
    return {
        "flight_longest": max(lengths, default=0.0),
        "flight_fall_off_g": off[longest] if off else 0.0,
        "flight_fall_off_g_most": max((abs(x) for x in off), default=0.0),
        "fall_90": float(quantile(fall, 98)[0]) if len(fall) else 0.0,
    }


def _together(motion: Motion, states: BodyStates, local: Array) -> dict[str, float]:
    """Return how arms, pelvis and weight go with the legs: against each other in walking."""
    differs = {
        joint: local[:, CANONICAL.index(f"left_{joint}")]
        - local[:, CANONICAL.index(f"right_{joint}")]
        for joint in ("wrist", "ankle", "knee", "hip", "foot", "shoulder")
    }
    legs, thighs, arms = (differs[name][:, 0] for name in ("ankle", "knee", "wrist"))
    left, right = (sole[..., 2].min(axis=1) for sole in states.soles)
    between = np.mean([sole.mean(axis=1) for sole in states.soles], axis=0)
    to_feet = rot.rotate(rot.about_axis(2, -motion.heading), motion.root - between)
    heels = median(differs["ankle"][:, 1])
    return {
        "arms_with_legs": _correlation(arms, legs),
        "shoulders_with_legs": _correlation(differs["shoulder"][:, 0], legs),
        "thighs_with_shanks": _correlation(thighs, legs - thighs),
        "hips_ahead_with_legs": _correlation(differs["hip"][:, 0], legs),
        "hips_up_with_feet": _correlation(differs["hip"][:, 2], left - right),
        "sway_with_feet": _correlation(to_feet[:, 1], left - right),
        "sway_ahead_with_legs": _correlation(to_feet[:, 0], np.abs(legs)),
        "toes_apart_over_heels": median(differs["foot"][:, 1]) - heels,
        "knees_apart_over_heels": median(differs["knee"][:, 1]) - heels,
        "feet_crossed_share": float(np.mean(differs["ankle"][:, 1] < 0.0)),
    }


def _correlation(a: Array, b: Array) -> float:
    """Return the correlation, near 0 where either hardly moves."""
    a, b = a - a.mean(), b - b.mean()
    return float(
        np.mean(a * b) / np.sqrt((np.mean(a**2) + _STILL**2) * (np.mean(b**2) + _STILL**2))
    )


def _reversals(motion: Motion, local: Array) -> dict[str, float]:
    """Return how often parts change their direction [1/s], from speeds through zero."""
    out = {}
    for name in ("wrist", "ankle", "knee"):
        places = local[:, [CANONICAL.index(f"{side}_{name}") for side in SIDES]]
        out[f"{name}_reversals"] = _rate_of_reversals(places.reshape(motion.frames, -1), motion.fps)
    out["height_reversals"] = _rate_of_reversals(motion.root[:, 2:], motion.fps)
    return out


def _rate_of_reversals(places: Array, fps: float) -> float:
    """Return zero crossings of the velocity, weighted by how much each coordinate moves."""
    velocity = np.diff(places, axis=0)
    if len(velocity) < 2:
        return 0.0
    crossed = velocity[1:] * velocity[:-1] < 0.0
    weight = velocity.var(axis=0)
    return float((crossed.mean(axis=0) * fps * weight).sum() / (weight.sum() + 1e-6))
