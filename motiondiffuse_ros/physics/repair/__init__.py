"""Corrections that make a motion more plausible without changing what it shows."""

from motiondiffuse_ros.physics.repair.ground import put_on_floor, stance_height
from motiondiffuse_ros.physics.repair.repair import Repair, repair, repair_best

__all__ = ["Repair", "put_on_floor", "repair", "repair_best", "stance_height"]
