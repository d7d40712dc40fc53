"""Distances between a robot's own solids for mink: kept, and restored where they were lost."""

from __future__ import annotations

import mink
import mujoco
import numpy as np
from mink.limits import Constraint

from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.self_collision import DISTANCE

_WATCHED = 0.03  # distance at which a pair begins to count [m]
_MOST = 0.02  # by which a step moves a pair apart that is too near [m]


class Clearance(mink.CollisionAvoidanceLimit):
    """As mink's limit, which keeps pairs from coming nearer, but parts those that are too near."""

    def __init__(self, robot: Robot, pairs: tuple[tuple[int, int], ...]) -> None:
        """Take the pairs of geoms."""
        super().__init__(
            robot.model,
            [((a,), (b,)) for a, b in pairs],
            minimum_distance_from_collisions=DISTANCE,
            collision_detection_distance=_WATCHED,
        )
        self.parting = True
        """Whether pairs that are too near have to part; False only keeps them from coming nearer,
        which is possible from any pose."""

    def compute_qp_inequalities(self, configuration: mink.Configuration, dt: float) -> Constraint:
        """Return a row for each pair that is near."""
        model, data, ends = self.model, configuration.data, np.empty(6)
        rows, room = [], []
        for pair in self._broadphase_survivors(data):
            one, other = self.geom_id_pairs[pair]
            distance = mujoco.mj_geomDistance(model, data, one, other, _WATCHED, ends)
            if distance >= _WATCHED:
                continue
            rows.append(self._approach(data, one, other, ends) * (1.0 if distance < 0.0 else -1.0))
            room.append(max(distance - DISTANCE, -_MOST if self.parting else 0.0))
        if not rows:
            return Constraint()
        return Constraint(G=np.array(rows), h=np.array(room))

    def _approach(self, data: mujoco.MjData, one: int, other: int, ends: np.ndarray) -> np.ndarray:
        """Return the Jacobian [nv] of the distance between the nearest points of two geoms."""
        near, far = np.empty((2, 3, self.model.nv))
        bodies = self.model.geom_bodyid
        mujoco.mj_jac(self.model, data, near, None, ends[:3], bodies[one])
        mujoco.mj_jac(self.model, data, far, None, ends[3:], bodies[other])
        normal = ends[3:] - ends[:3]
        return normal @ (far - near) / max(float(np.linalg.norm(normal)), 1e-9)
