"""Data sets: importers, captions, splits, statistics, and the corpus folder they make."""

from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.corpus.skeleton_map import SkeletonMap

__all__ = ["SkeletonMap", "load_motion"]
