"""The humanoid, what physics says about a motion, and how that is put into a verdict."""

from motiondiffuse_ros.physics.repair import put_on_floor
from motiondiffuse_ros.physics.report import Report, SegmentReport, assess

__all__ = ["Report", "SegmentReport", "assess", "put_on_floor"]
