"""Where a body is over the floor, and how its feet hold on to it."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.foot_skating import skating_of
from motiondiffuse_ros.physics.statistics.frames import median, quantiles

_NEAR = 0.025  # m above the lowest corner: what may be holding on


def footing(states: BodyStates) -> dict[str, float]:
    """Return heights [m], slides [m/s] and rates [1/s] of the feet."""
    lowest = states.points.places[..., 2].min(axis=1)
    corners = np.concatenate(states.soles, axis=1)
    velocity = np.diff(corners, axis=0) * states.fps
    height = np.maximum(corners[1:, :, 2], corners[:-1, :, 2])
    near = height < height.min(axis=1, keepdims=True) + _NEAR
    speed = np.where(near, np.linalg.norm(velocity[..., :2], axis=-1), np.inf)
    holding, frames = speed.argmin(axis=1), np.arange(len(speed))
    slide, drift = speed[frames, holding], velocity[frames, holding, :2]
    mean_drift = float(np.linalg.norm(drift.mean(axis=0)))
    skating = skating_of(states.feet, states.soles, states.fps)
    left, right = (sole[..., 2].min(axis=1) for sole in states.soles)
    lower, apart = np.minimum(left, right), left - right
    path = np.linalg.norm(np.diff(states.qpos[:, :2], axis=0), axis=1) * states.fps
    turns = np.sign(apart[np.abs(apart) > 0.02])
    steps = float(np.sum(np.diff(turns) != 0) * states.fps / len(apart))
    travel = quantiles("travel_speed", path, 50, 90)
    airborne = float(np.mean(lower > 0.05))
    return {
        **quantiles("lowest_point", lowest, 2, 10, 50, 90, 98),
        **quantiles("foot_slide", slide, 10, 25, 50, 75),
        "foot_drift_median": float(np.linalg.norm(np.median(drift, axis=0))),
        "foot_drift_mean": mean_drift,
        "foot_drift_of_slide": mean_drift / (float(slide.mean()) + 0.02),
        "foot_slide_on_floor": median(np.where(height.min(axis=1) < 0.04, slide, 0.0)),
        "skating_in_contact": skating.contact_ratio,
        "skating": skating.ratio,
        **travel,
        "step_rate": steps,
        "step_length_over_rate": float(np.log((median(path) + 0.1) / (steps + 0.3))),
        "low_foot_share": float(np.mean(lower < lowest.min() + 0.06)),
        "airborne_share": airborne,
        "speed_on_the_ground": travel["travel_speed_50"] * (1.0 - airborne),
    }
