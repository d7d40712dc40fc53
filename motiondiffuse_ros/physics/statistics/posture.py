"""How a body stands: its soles, its legs, its centre of mass over its feet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.dynamics import Dynamics
from motiondiffuse_ros.physics.statistics.frames import in_heading, median, planted, quantiles

_UP, _AHEAD = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
_TRUNK = ("pelvis", "spine3", "head")
_LEG_HINGES = ("hip_x", "hip_z", "ankle_x", "ankle_z", "knee_x", "knee_z", "foot_x")
_USUAL_TOE_OUT = 0.2  # rad, where no two planted feet show it


def posture(motion: Motion, states: BodyStates, dynamics: Dynamics) -> dict[str, float]:
    """Return tilts and angles [rad, or the sine of them] and distances [m]."""
    heading = motion.heading
    return {
        **_soles(motion, states, heading),
        **_centre_over_feet(states, dynamics, heading),
        **_trunk(motion, heading),
        **_legs(motion, states),
    }


def _soles(motion: Motion, states: BodyStates, heading: Array) -> dict[str, float]:
    rests = [planted(sole, states.fps) for sole in states.soles]
    feet = [
        _resting_foot(motion, heading, side, sole, rest)
        for side, sole, rest in zip(SIDES, states.soles, rests, strict=True)
    ]
    known = [foot for foot in feet if foot is not None]
    out: dict[str, float] = dict.fromkeys(
        ("sole_pitch", "sole_roll", "sole_tilt", "sole_unevenness", "planted_height"), 0.0
    )
    if known:
        ahead, aside, tilt_x, tilt_y, uneven, height, _ = np.array(known).T
        out = {
            "sole_pitch": float(ahead.mean()),
            "sole_roll": float(abs(aside.mean())),
            "sole_tilt": float(np.hypot(tilt_x.mean(), tilt_y.mean())),
            "sole_unevenness": float(uneven.max()),
            "planted_height": float(height.mean()),
        }
    left, right = feet
    if left is None or right is None:
        pair = {
            "toe_out": _USUAL_TOE_OUT,
            "feet_height_difference": 0.0,
            "sole_roll_difference": 0.0,
            "sole_pitch_difference": 0.0,
        }
        turned = 0.0
    else:
        pair = {
            "toe_out": left[6] - right[6],
            "feet_height_difference": abs(left[5] - right[5]),
            "sole_roll_difference": left[1] - right[1],
            "sole_pitch_difference": abs(left[0] - right[0]),
        }
        turned = abs(left[6] + right[6]) / 2.0
    return {
        **out,
        **pair,
        "feet_heading": turned,
        "planted_share": float(np.mean(rests[0] | rests[1])),
        "both_planted_share": float(np.mean(rests[0] & rests[1])),
    }


def _resting_foot(
    motion: Motion, heading: Array, side: str, sole: Array, rest: NDArray[np.bool_]
) -> tuple[float, ...] | None:
    """Return, where a foot rests: its normal ahead, aside and in the world, unevenness, height
    and heading; None if it never does for two frames."""
    if rest.sum() < 2:
        return None
    turn = motion.global_rotations[:, CANONICAL.index(f"{side}_ankle")]
    normal, toes = rot.rotate(turn, _UP), in_heading(heading, rot.rotate(turn, _AHEAD))[rest]
    ahead, aside, _ = in_heading(heading, normal)[rest].mean(axis=0)
    tilt_x, tilt_y, _ = normal[rest].mean(axis=0)
    heights = sole[rest][..., 2]
    uneven, height = median(np.ptp(heights, axis=1)), median(heights.min(axis=1))
    x, y, _ = toes.mean(axis=0)
    return (*map(float, (ahead, aside, tilt_x, tilt_y, uneven, height, np.arctan2(y, x))),)


def _centre_over_feet(states: BodyStates, dynamics: Dynamics, heading: Array) -> dict[str, float]:
    feet = np.mean([sole.mean(axis=1) for sole in states.soles], axis=0)[1:-1]
    away = dynamics.centre - feet
    ahead, aside, _ = in_heading(heading[1:-1], away).T
    return {
        "centre_ahead_median": median(ahead),
        "centre_aside_median": abs(median(aside)),
        "centre_ahead_mean": float(ahead.mean()),
        "centre_aside_mean": float(abs(aside.mean())),
        "centre_off_mean": float(np.linalg.norm(away[:, :2].mean(axis=0))),
        "centre_off_median": median(np.linalg.norm(away[:, :2], axis=1)),
    }


def _trunk(motion: Motion, heading: Array) -> dict[str, float]:
    out = {}
    for name in _TRUNK:
        up = rot.rotate(motion.global_rotations[:, CANONICAL.index(name)], _UP)
        ahead, aside, _ = np.median(in_heading(heading, up), axis=0)
        out[f"{name}_pitch"], out[f"{name}_roll"] = float(ahead), float(abs(aside))
        out[f"{name}_tilt"] = float(np.linalg.norm(up.mean(axis=0)[:2]))
    return out


def _legs(motion: Motion, states: BodyStates) -> dict[str, float]:
    root = rot.conjugate(motion.global_rotations[:, :1])
    local = rot.rotate(root, motion.positions - motion.positions[:, :1])
    out: dict[str, float] = {}
    for joint in ("ankle", "knee"):
        left, right = (local[:, CANONICAL.index(f"{side}_{joint}"), 1] for side in SIDES)
        out |= quantiles(f"{joint}s_apart", left - right, 10, 50, 90)
    names = list(states.joint_names)
    for hinge in _LEG_HINGES:
        left, right = (states.qpos[:, 7 + names.index(f"{side}_{hinge}")] for side in SIDES)
        out[f"{hinge}_left_minus_right"] = median(left) - median(right)
    return out
