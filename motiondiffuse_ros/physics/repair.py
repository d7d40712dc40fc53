"""Small corrections that make a motion more plausible without changing what it shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.geometry import sole_probes

_STANCE_PERCENTILE = 30.0


def put_on_floor(motion: Motion) -> Motion:
    """Move a motion vertically, as a whole, so that its stance is on the floor at z = 0.

    The height of the stance is a low quantile over frames of the lowest corner of a sole: below
    it are toes that dip at push-off, above it feet in flight. Of 10 to 50 % this one leaves the
    smallest phys-err on real clips of both sets.
    """
    heights = [sole_probes(side).heights(motion).min(axis=1) for side in ("left", "right")]
    stance = float(np.percentile(np.minimum(*heights), _STANCE_PERCENTILE))
    return replace(motion, root=motion.root - np.array([0.0, 0.0, stance]))
