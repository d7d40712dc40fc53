"""How fast a body moves, and how fast that changes: what tells a film that is run too fast.

Speeds alone do not: a quick gesture is no slow one sped up. Ratios of acceleration to speed and of
jerk to acceleration are frequencies, and bodies of one size have theirs.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.statistics.frames import log_of, median, quantile

_GROUPS = {
    "hands": ("left_wrist", "right_wrist"),
    "feet": ("left_ankle", "right_ankle"),
    "head": ("head",),
    "elbows": ("left_elbow", "right_elbow"),
    "knees": ("left_knee", "right_knee"),
}
_HINGES = {
    "arms": ("shoulder", "elbow", "wrist"),
    "legs": ("hip", "knee", "ankle"),
    "trunk": ("spine", "head", "neck"),
}
_AFTER = 6  # frames
_BANDS = ((1.0, 2.0), (2.0, 4.0), (4.0, 7.0), (7.0, 10.1))  # Hz


def tempo(motion: Motion, states: BodyStates, local: Array) -> dict[str, float]:
    """Return logarithms of speeds, accelerations, jerks and of ratios between them.

    `local` are the joints `from_root`.
    """
    out: dict[str, float] = {}
    for name, joints in _GROUPS.items():
        out |= _pace(name, local[:, [CANONICAL.index(j) for j in joints]], motion.fps)
    root = motion.positions[:, :1]
    out |= _pace("root", root, motion.fps)
    out |= _pace("root_height", root * np.array([0.0, 0.0, 1.0]), motion.fps)
    out |= _whole_body(motion)
    for name, parts in _HINGES.items():
        columns = [7 + n for n, j in enumerate(states.joint_names) if any(p in j for p in parts)]
        out |= _spectrum(name, states.qpos[:, columns], states.fps)
    return out


def _pace(name: str, places: Array, fps: float) -> dict[str, float]:
    derivatives = [np.diff(places, n=n, axis=0) * fps**n for n in (1, 2, 3)]
    v, a, j = (float(np.sqrt((d**2).sum(axis=-1).mean())) for d in derivatives)
    speed, acceleration, jerk = (np.linalg.norm(d, axis=-1) for d in derivatives)
    return {
        f"{name}_speed": log_of(v, 0.02),
        f"{name}_acceleration_over_speed": float(np.log((a + 0.2) / (v + 0.05))),
        f"{name}_jerk_over_acceleration": float(np.log((j + 4.0) / (a + 0.5))),
        f"{name}_acceleration_50": log_of(median(acceleration), 0.1),
        f"{name}_jerk_50": log_of(median(jerk), 2.0),
        f"{name}_speed_90": log_of(_upper(speed.max(axis=1)), 0.05),
        f"{name}_acceleration_90": log_of(_upper(acceleration.max(axis=1)), 0.3),
        f"{name}_jerk_peak_over_usual": float(
            np.log((jerk.max() + 10.0) / (float(quantile(jerk.max(axis=1), 80)[0]) + 10.0))
        ),
    }


def _whole_body(motion: Motion) -> dict[str, float]:
    steps = np.diff(motion.positions, axis=0)
    jerk = np.linalg.norm(np.diff(steps, n=2, axis=0), axis=-1).max(axis=1) * motion.fps**3
    speed = np.linalg.norm(steps, axis=-1).mean(axis=1) * motion.fps
    change = np.abs(np.diff(speed)) * motion.fps
    # how much slower the body is at once, for the next frames, than just before
    after = sliding_window_view(np.append(speed, np.repeat(speed[-1], _AFTER)), _AFTER).mean(axis=1)
    stops = np.log((speed[:-1] + 0.02) / (after[1:-1] + 0.02))
    starts = np.log((after[1:-1] + 0.02) / (speed[:-1] + 0.02))
    return {
        "jerk_50": log_of(median(jerk), 20.0),
        "jerk_90": log_of(_upper(jerk), 20.0),
        "jerk_100": log_of(float(jerk.max()), 20.0),
        "sudden_stop": float(stops.max()),
        "sudden_start": float(starts.max()),
        "stillest_frame": log_of(float(speed.min()), 0.005),
        "change_of_speed_100": float(change.max()),
        "change_of_speed_peak_over_usual": float(
            np.log((change.max() + 0.5) / (_upper(change) + 0.5))
        ),
    }


def _spectrum(name: str, angles: Array, fps: float) -> dict[str, float]:
    velocity = np.diff(angles, axis=0) * fps
    window = np.hanning(len(velocity) + 2)[1:-1, None]
    power = np.abs(np.fft.rfft((velocity - velocity.mean(axis=0)) * window, axis=0)) ** 2
    power, frequency = power.sum(axis=1), np.fft.rfftfreq(len(velocity), 1.0 / fps)
    total = float(power.sum()) + 1e-3
    shares = {
        f"{name}_power_from_{low:.0f}_Hz": log_of(
            float(power[(frequency >= low) & (frequency < high)].sum()) / total, 1e-3
        )
        for low, high in _BANDS
    }
    fastest = np.abs(velocity).max(axis=1)
    return {
        f"{name}_mean_frequency": float((power * frequency).sum() / total),
        **shares,
        f"{name}_amplitude": log_of(float(np.std(angles, axis=0).max()), 0.02),
        f"{name}_turning_speed_90": log_of(_upper(fastest), 0.1),
        f"{name}_turning_speed_50": log_of(median(fastest), 0.1),
    }


def _upper(values: Array) -> float:
    return float(quantile(values, 90)[0])
