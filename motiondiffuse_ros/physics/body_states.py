"""Any body with a free root over time, as the measures need it; the humanoid's from a motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import SIDES
from motiondiffuse_ros.physics.floor_points import FloorPoints
from motiondiffuse_ros.physics.geometry import body_probes, sole_probes
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.humanoid import humanoid_model
from motiondiffuse_ros.physics.state import motion_to_qpos


class Limits(Protocol):
    """Limits of the joints beside the root, as a robot states them; infinite for none."""

    @property
    def lower(self) -> Array: ...

    @property
    def upper(self) -> Array: ...

    @property
    def velocity_limits(self) -> Array: ...

    @property
    def torque_limits(self) -> Array: ...


@dataclass(frozen=True, eq=False)
class BodyStates:
    """T states of a body with K joints beside its free root, on a floor at z = 0.

    Attributes:
        model: With contacts between its own parts.
        qpos: [T, 7 + K]; quaternions of one hemisphere, angles continuous.
        fps: Frames per second.
        limits: Of the K joints.
        joint_names: [K].
        points: What may touch the floor.
        point_names: What each point belongs to [P].
        feet: A point of each foot [T, F, 3], m, below 5 cm where the foot stands.
        foot_names: [F].
        soles: Points of each sole [T, C, 3], m.
        places: Points whose smoothness counts [T, J, 3], m.
        place_names: [J].
    """

    model: mujoco.MjModel = field(repr=False)
    qpos: Array = field(repr=False)
    fps: float
    limits: Limits = field(repr=False)
    joint_names: Sequence[str] = field(repr=False)
    points: FloorPoints = field(repr=False)
    point_names: Sequence[str] = field(repr=False)
    feet: Array = field(repr=False)
    foot_names: Sequence[str] = field(repr=False)
    soles: Sequence[Array] = field(repr=False)
    places: Array = field(repr=False)
    place_names: Sequence[str] = field(repr=False)


def humanoid_states(motion: Motion, limits: Limits) -> BodyStates:
    """Return a motion as states of the humanoid."""
    probes = body_probes()
    places = probes.centres(motion)
    places[..., 2] -= probes.radii
    return BodyStates(
        model=humanoid_model(),
        qpos=motion_to_qpos(motion),
        fps=motion.fps,
        limits=limits,
        joint_names=hinge_table().names,
        points=FloorPoints(places, _probe_bodies()),
        point_names=[CANONICAL.names[j] for j in probes.joints],
        feet=motion.positions[:, [CANONICAL.index(f"{side}_foot") for side in SIDES]],
        foot_names=[f"{side}_foot" for side in SIDES],
        soles=[sole_probes(side).centres(motion) for side in SIDES],
        places=motion.positions,
        place_names=CANONICAL.names,
    )


@cache
def _probe_bodies() -> NDArray[np.intp]:
    model = humanoid_model()
    return np.array([model.body(CANONICAL.names[j]).id for j in body_probes().joints])
