"""Residuals between simulated and wanted bodies, whose squares are the cost of a plan."""

from __future__ import annotations

import mujoco
import numpy as np

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.tracking.config import CostWeights
from motiondiffuse_ros.physics.tracking.model import (
    CENTRE,
    MOMENTUM,
    ORIENTATION,
    POSITIONS,
    VELOCITY,
)

_FEET = ("left_ankle", "right_ankle", "left_foot", "right_foot")
_LOST = 1e3  # residual of a simulation that broke down


def sensor_weights(weights: CostWeights, model: mujoco.MjModel) -> Array:
    """Return the weight of every sensor's value [S], the orientation's last component left out."""
    joints = np.full(len(CANONICAL.names), weights.joints)
    joints[[CANONICAL.index(name) for name in _FEET]] = weights.feet
    out = np.empty(model.nsensordata - 1)
    out[POSITIONS] = np.repeat(joints, 3)
    # a rotation vector has a component less than the quaternion that it stands for
    out[ORIENTATION.start : ORIENTATION.stop - 1] = weights.orientation
    for where, weight in (
        (CENTRE, weights.centre),
        (VELOCITY, weights.velocity),
        (MOMENTUM, weights.momentum),
    ):
        out[where.start - 1 : where.stop - 1] = weight
    return out


def residuals(sensed: Array, wanted: Array, weights: Array) -> Array:
    """Return weighted differences [..., S - 1] of sensors [..., S] from the reference's."""
    turned = rot.to_rotation_vector(
        rot.multiply(sensed[..., ORIENTATION], rot.conjugate(wanted[..., ORIENTATION]))
    )
    off = sensed - wanted
    out = np.concatenate(
        [off[..., : ORIENTATION.start], turned, off[..., ORIENTATION.stop :]], axis=-1
    )
    out = np.nan_to_num(out, nan=_LOST, posinf=_LOST, neginf=-_LOST)
    return np.clip(out, -_LOST, _LOST) * weights
