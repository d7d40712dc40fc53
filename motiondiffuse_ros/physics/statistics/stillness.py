"""Whether a body that holds still could: balanced as it stands, and not stopped out of a run."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.dynamics import Dynamics
from motiondiffuse_ros.physics.statistics.frames import log_of, median, quantile, worst_window

_STILL = 0.04  # m/s, mean over the joints
_WINDOW = 6  # frames


def stillness(states: BodyStates, dynamics: Dynamics) -> dict[str, float]:
    """Return distances [m] while still, and logarithms of speeds [m/s] before stops."""
    steps = np.linalg.norm(np.diff(states.places, axis=0), axis=-1).mean(axis=1) * states.fps
    speed = np.maximum(steps[1:], steps[:-1])
    still = speed < _STILL
    off = dynamics.poise
    outside = np.maximum(np.nan_to_num(off.from_support, nan=1.0), 0.0)
    left, right = (sole[..., 2].min(axis=1)[1:-1] for sole in states.soles)
    figures = {
        "still_off_support": outside,
        "still_foot_aloft": np.abs(left - right),
    }
    return {
        **{name: float(v[still].mean()) if still.any() else 0.0 for name, v in figures.items()},
        **_stops(steps, dynamics, states.fps),
        "stillness_50": log_of(median(speed), 0.01),
        "off_support_90": float(quantile(outside, 90)[0]),
        "off_next_step_mean": float(np.maximum(np.nan_to_num(off.from_next_step), 0.0).mean()),
        "off_next_step_worst": worst_window(np.maximum(np.nan_to_num(off.from_next_step), 0.0), 5),
    }


def _stops(steps: np.ndarray, dynamics: Dynamics, fps: float) -> dict[str, float]:
    """Return the fastest the body, and its centre, was just before it held still."""
    centre = np.linalg.norm(np.diff(dynamics.centre, axis=0), axis=1) * fps
    body = momentum = 0.0
    for at in range(2, len(steps) - _WINDOW):
        if steps[at : at + _WINDOW].max() < _STILL:
            body = max(body, float(steps[at - 2 : at].max()))
            before = centre[max(at - 4, 0) : max(at - 1, 1)]
            momentum = max(momentum, float(before.max(initial=0.0)))
    return {"stop_from_speed": log_of(body, 0.05), "stop_from_momentum": log_of(momentum, 0.05)}
