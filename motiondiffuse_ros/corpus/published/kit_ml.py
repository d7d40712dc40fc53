"""KIT-ML as HumanML3D's authors processed and published it."""

from __future__ import annotations

from motiondiffuse_ros.corpus.published.guo import GuoFolder
from motiondiffuse_ros.motion.representations import KitML


class KitMLFolder(GuoFolder):
    """The folder `KIT-ML`, unpacked."""

    name = "kit_ml"
    fps = 12.5
    min_frames = 24
    representation = KitML()
