"""Named statistics of a motion: what the fitted score weighs, one number each."""

from motiondiffuse_ros.physics.statistics.summary import statistics

__all__ = ["statistics"]
