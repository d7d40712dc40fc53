"""Physical measures of motions as they come, before any repair."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.foot_skating import foot_skating
from motiondiffuse_ros.physics.ground_contact import ground_errors
from motiondiffuse_ros.physics.smoothness import joint_jerk

MEASURES = ("phys_err_mm", "float_mm", "penetrate_mm", "skating_ratio", "jerk_m_s3")


def plausibility(motions: Iterable[Motion]) -> dict[str, float]:
    """Return the mean over motions of each of `MEASURES`, the floor being at z = 0."""
    rows = []
    for motion in motions:
        ground = ground_errors(motion)
        rows.append(
            (
                ground.phys_err.mean(),
                ground.float_.mean(),
                ground.penetrate.mean(),
                foot_skating(motion).ratio,
                joint_jerk(motion).mean(),
            )
        )
    return dict(zip(MEASURES, map(float, np.mean(rows, axis=0)), strict=True))
