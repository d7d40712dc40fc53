"""Points of a body that may push against the floor."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from motiondiffuse_ros.motion.rotations import Array

CONTACT_HEIGHT = 0.04
"""A point of the body below this [m] may push against the floor."""


@dataclass(frozen=True, eq=False)
class FloorPoints:
    """Points of a body that may push against the floor.

    Attributes:
        places: World positions over time [T, P, 3], m.
        bodies: Index of the MuJoCo body that each belongs to [P].
    """

    places: Array = field(repr=False)
    bodies: NDArray[np.intp] = field(repr=False)

    def touching(self) -> NDArray[np.bool_]:
        """Return which points may push [T, P]: in a frame, or in a neighbour of it.

        Central differences look that far.
        """
        return np.asarray(maximum_filter1d(self.places[..., 2] < CONTACT_HEIGHT, 3, axis=0), bool)
