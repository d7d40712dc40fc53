"""HumanML3D (github.com/EricGuo5513/HumanML3D)."""

from __future__ import annotations

from motiondiffuse_ros.corpus.published.guo import GuoFolder
from motiondiffuse_ros.motion.representations import HumanML3D


class HumanML3DFolder(GuoFolder):
    """The folder `HumanML3D` of the repository, complete and unpacked."""

    name = "humanml3d"
    fps = 20.0
    min_frames = 40
    representation = HumanML3D()
