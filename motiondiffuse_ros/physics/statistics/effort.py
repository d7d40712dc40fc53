"""Forces: what the floor cannot give, what joints must give, how the centre of mass moves."""

from __future__ import annotations

import numpy as np

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.dynamics import Dynamics
from motiondiffuse_ros.physics.joint_limits import POSITION_TOLERANCE
from motiondiffuse_ros.physics.statistics.frames import quantiles, worst_window

_MASS = 70.0
_LEG = ("hip", "knee", "ankle")


def effort(states: BodyStates, dynamics: Dynamics) -> dict[str, float]:
    """Return residuals [body weights], torques over limits, power [W/kg], accelerations [m/s^2]."""
    limits, angles = states.limits, states.qpos[:, 7:]
    leg = np.array([any(part in name for part in _LEG) for name in states.joint_names])
    used = np.abs(dynamics.torques) / limits.torque_limits
    power = np.maximum(dynamics.power, 0.0).sum(axis=1) / _MASS
    beyond = np.maximum(limits.lower - angles, angles - limits.upper) > POSITION_TOLERANCE
    speed = np.abs(np.diff(angles, axis=0)) * states.fps
    return {
        **_residual("residual_force", dynamics.residual_force),
        **_residual("residual_torque", dynamics.residual_torque),
        "residual_force_worst_quarter_second": worst_window(dynamics.residual_force, 5),
        "unsupported_share": float(1.0 - dynamics.supported.mean()),
        **quantiles("torque_used", used.max(axis=1), 50, 90, 100),
        "torque_used_mean": float(used.mean()),
        **quantiles("leg_torque_used", used[:, leg].max(axis=1), 90),
        **quantiles("power", power, 50, 90, 100),
        **_centre(dynamics.centre, states.fps),
        "beyond_range_share": float(beyond.any(axis=1).mean()),
        "leg_beyond_range_share": float(beyond[:, leg].any(axis=1).mean()),
        "too_fast_share": float((speed > limits.velocity_limits).any(axis=1).mean()),
    }


def _residual(name: str, values: Array) -> dict[str, float]:
    return {
        f"{name}_mean": float(values.mean()),
        **quantiles(name, values, 50, 90, 100),
        f"{name}_worst_half_second": worst_window(values, 10),
    }


def _centre(centre: Array, fps: float) -> dict[str, float]:
    acceleration = np.diff(centre, n=2, axis=0) * fps**2
    if not len(acceleration):
        acceleration = np.zeros((1, 3))
    across = np.linalg.norm(acceleration[:, :2], axis=1)
    return {
        **quantiles("centre_acceleration_up", acceleration[:, 2], 2, 98),
        "centre_acceleration_up_rms": float(np.sqrt(np.mean(acceleration[:, 2] ** 2))),
        **quantiles("centre_acceleration_across", across, 90, 100),
    }
