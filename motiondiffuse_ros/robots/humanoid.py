"""The default robot: the canonical skeleton itself, as `physics/humanoid.py` builds it."""

from __future__ import annotations

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.humanoid import humanoid_model, rest_angles
from motiondiffuse_ros.robots.robot import RobotDescription


def describe_humanoid() -> RobotDescription:
    """Return the description of the 63-joint humanoid."""
    table = hinge_table()
    return RobotDescription(
        name="humanoid",
        model=humanoid_model,
        speed_limits=dict(zip(table.names, table.velocity_limits.tolist(), strict=True)),
        rest=dict(zip(table.names, rest_angles().tolist(), strict=True)),
        body_map={name: name for name in CANONICAL.names},
        retargeting="exact",
    )
