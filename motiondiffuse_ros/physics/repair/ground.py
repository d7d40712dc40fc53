"""The height of the floor that a motion stands on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.geometry import sole_probes

_STANCE_PERCENTILE = 30.0


def put_on_floor(motion: Motion) -> Motion:
    """Move a motion vertically, as a whole, so that its stance is on the floor at z = 0."""
    return replace(motion, root=motion.root - np.array([0.0, 0.0, stance_height(motion)]))


def stance_height(motion: Motion) -> float:
    """Return the height [m] of a motion's stance: a low quantile over frames of the lowest sole.

    Below it are toes that dip at push-off, above it feet in flight. Of 10 to 50 % this one leaves
    the smallest phys-err on real clips of both sets when it is put at zero.
    """
    heights = [sole_probes(side).heights(motion).min(axis=1) for side in ("left", "right")]
    return float(np.percentile(np.minimum(*heights), _STANCE_PERCENTILE))
