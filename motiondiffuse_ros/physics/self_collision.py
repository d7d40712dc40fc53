"""How deep parts of a body are inside each other that are not so at rest."""

from __future__ import annotations

from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion.rotations import Array

TOLERANCE = 0.01
"""Solids are simpler than bodies: they may overlap by this much [m]."""


def self_overlap(model: mujoco.MjModel, qpos: Array) -> tuple[Array, list[str]]:
    """Measure every frame.

    Args:
        model: With contacts, and without those pairs that may overlap always.
        qpos: [T, nq].

    Returns:
        Depth of the deepest overlap beyond `TOLERANCE` [T], m, and the two bodies of it, "" where
        there is none.
    """
    data = mujoco.MjData(model)
    usual = _overlaps_at_rest(model)
    depths, who = np.zeros(len(qpos)), [""] * len(qpos)
    for i, state in enumerate(qpos):
        data.qpos = state
        overlap, pairs = _overlaps(model, data)
        unusual = np.where(usual[pairs], 0.0, overlap)
        if len(unusual) and unusual.max() > TOLERANCE:
            deepest = int(unusual.argmax())
            depths[i] = unusual[deepest]
            pair = divmod(int(pairs[deepest]), model.nbody)
            who[i] = " and ".join(model.body(body).name for body in pair)
    return depths, who


@lru_cache(maxsize=8)
def _overlaps_at_rest(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """Return which pairs do [nbody * nbody]."""
    usual = np.zeros(model.nbody**2, dtype=bool)
    usual[_overlaps(model, mujoco.MjData(model))[1]] = True
    return usual


def _overlaps(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Array, NDArray[np.intp]]:
    """Return the depths [N] of all overlaps, m, and their bodies a < b as a * nbody + b."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    if not data.ncon:
        return np.empty(0), np.empty(0, dtype=np.intp)
    one, other = model.geom_bodyid[data.contact.geom].T
    depth, first = -data.contact.dist, np.minimum(one, other)
    own = (first > 0) & (depth > 0.0)
    return depth[own], (first * model.nbody + np.maximum(one, other))[own].astype(np.intp)
