"""The representations of the data sets of the paper; our own is `motion.features.PoseState`."""

from motiondiffuse_ros.motion.representations.humanml3d import HumanML3D
from motiondiffuse_ros.motion.representations.joint_positions import JointPositions
from motiondiffuse_ros.motion.representations.kit_ml import KitML
from motiondiffuse_ros.motion.representations.root_rotations import RootRotations

__all__ = ["HumanML3D", "JointPositions", "KitML", "RootRotations"]
