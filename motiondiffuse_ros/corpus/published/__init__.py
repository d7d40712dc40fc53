"""Importers of the paper's data sets, each in the layout in which it is published."""

from motiondiffuse_ros.corpus.published.babel import Babel
from motiondiffuse_ros.corpus.published.dataset import ImportedClip, PublishedDataset
from motiondiffuse_ros.corpus.published.humanact12 import HumanAct12
from motiondiffuse_ros.corpus.published.humanml3d import HumanML3DFolder
from motiondiffuse_ros.corpus.published.kit_ml import KitMLFolder
from motiondiffuse_ros.corpus.published.uestc import Uestc

__all__ = [
    "Babel",
    "HumanAct12",
    "HumanML3DFolder",
    "ImportedClip",
    "KitMLFolder",
    "PublishedDataset",
    "Uestc",
]
