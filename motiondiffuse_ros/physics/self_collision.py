"""How deep parts of a body are inside each other that are not so at rest."""

from __future__ import annotations

from functools import lru_cache

import mujoco
import numpy as np

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
        for depth, pair in _overlaps(model, data):
            if depth > max(depths[i], TOLERANCE) and pair not in usual:
                depths[i] = depth
                who[i] = " and ".join(model.body(body).name for body in pair)
    return depths, who


@lru_cache(maxsize=8)
def _overlaps_at_rest(model: mujoco.MjModel) -> frozenset[tuple[int, int]]:
    data = mujoco.MjData(model)
    return frozenset(pair for _, pair in _overlaps(model, data))


def _overlaps(model: mujoco.MjModel, data: mujoco.MjData) -> list[tuple[float, tuple[int, int]]]:
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    if not data.ncon:
        return []
    bodies = np.sort(model.geom_bodyid[data.contact.geom], axis=1)
    own = (bodies[:, 0] > 0) & (data.contact.dist < 0.0)
    return [
        (float(-depth), (int(a), int(b)))
        for depth, (a, b) in zip(data.contact.dist[own], bodies[own], strict=True)
    ]
