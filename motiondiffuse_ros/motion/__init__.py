"""Skeleton, motion, its features and its files. The room everything else stands on."""

from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.parts import PARTS
from motiondiffuse_ros.motion.skeleton import CANONICAL, Skeleton

__all__ = ["CANONICAL", "PARTS", "Motion", "Skeleton"]
