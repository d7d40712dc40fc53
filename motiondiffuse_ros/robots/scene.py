"""What a robot's model lacks to stand in and to be looked at."""

from __future__ import annotations

import mujoco

from motiondiffuse_ros.physics.humanoid import add_scene


def add_floor(spec: mujoco.MjSpec) -> None:
    """Add floor, light and sky to a model without a floor; its own lights would be too many."""
    if any(geom.type == mujoco.mjtGeom.mjGEOM_PLANE for geom in spec.worldbody.geoms):
        return
    for light in list(spec.worldbody.lights):
        spec.delete(light)
    add_scene(spec)
