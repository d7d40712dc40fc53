"""`Motion`: what a body does over time, independent of robot, file format and model."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import CANONICAL, Skeleton

_MIRROR_VECTOR = np.array([1.0, -1.0, 1.0])
# a reflection across the x-z plane turns a rotation's axis like a pseudo-vector
_MIRROR_QUATERNION = np.array([1.0, -1.0, 1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Motion:
    """Joint rotations and root path of a skeleton, uniformly sampled.

    World frame: x forward, y left, z up, floor at z = 0 (REP-103).

    Attributes:
        root: Position of the root joint [T, 3], m.
        rotations: Rotation of each joint relative to its parent [T, J, 4], wxyz, unit length;
            the root's is relative to the world.
        fps: Frames per second.
        skeleton: The kinematic tree; J joints.
    """

    root: Array = field(repr=False)
    rotations: Array = field(repr=False)
    fps: float
    skeleton: Skeleton = field(default=CANONICAL, repr=False)

    def __post_init__(self) -> None:
        frames, joints = len(self.root), len(self.skeleton.names)
        if self.root.shape != (frames, 3) or self.rotations.shape != (frames, joints, 4):
            raise ValueError(
                f"a motion of {joints} joints needs root [T, 3] and rotations [T, {joints}, 4], "
                f"got {self.root.shape} and {self.rotations.shape}"
            )
        if frames == 0 or not self.fps > 0:
            raise ValueError(
                f"a motion needs frames and a positive rate, got {frames} and {self.fps}"
            )

    @property
    def frames(self) -> int:
        """Number of frames T."""
        return len(self.root)

    @property
    def duration(self) -> float:
        """Time from the first to the last frame [s]."""
        return (self.frames - 1) / self.fps

    @cached_property
    def global_rotations(self) -> Array:
        """World rotations [T, J, 4], wxyz."""
        return self.skeleton.global_rotations(self.rotations)

    @cached_property
    def positions(self) -> Array:
        """World joint positions [T, J, 3], m."""
        return self.skeleton.positions(self.root, self.global_rotations)

    def joint(self, name: str) -> Array:
        """World positions [T, 3] of one joint, m."""
        return self.positions[:, self.skeleton.index(name)]

    @cached_property
    def heading(self) -> Array:
        """Root heading about the vertical [T], rad, unwrapped; 0 faces +x."""
        return np.unwrap(rot.twist_angle(self.rotations[:, 0], axis=2))

    def with_root(self, root: Array) -> Motion:
        """Return the same rotations on another path of the root [T, 3], m."""
        moved = replace(self, root=root)
        if "global_rotations" in self.__dict__:
            moved.__dict__["global_rotations"] = self.global_rotations
        return moved

    def slice(self, start: int, stop: int) -> Motion:
        """Return the frames from start up to, not including, stop."""
        return replace(self, root=self.root[start:stop], rotations=self.rotations[start:stop])

    def canonicalised(self) -> Motion:
        """Move the first frame's root over the origin, facing +x; heights stay."""
        back = rot.about_axis(2, -self.heading[0])
        root = rot.rotate(back, self.root - self.root[0] * [1.0, 1.0, 0.0])
        rotations = self.rotations.copy()
        rotations[:, 0] = rot.multiply(back, rotations[:, 0])
        return replace(self, root=root, rotations=rotations)

    def mirrored(self) -> Motion:
        """Swap left and right: reflect across the x-z plane."""
        swapped = self.rotations[:, list(self.skeleton.mirror_index)]
        return replace(
            self, root=self.root * _MIRROR_VECTOR, rotations=swapped * _MIRROR_QUATERNION
        )

    def reversed(self) -> Motion:
        """Play it from the last frame to the first."""
        return replace(self, root=self.root[::-1], rotations=self.rotations[::-1])

    def resample(self, fps: float) -> Motion:
        """Return the motion at another rate: C2 splines for positions and rotations."""
        from motiondiffuse_ros.motion.resample import sample_at

        if fps == self.fps:
            return self
        return sample_at(self, np.arange(self.frames_at(fps)) / fps, fps)

    def frames_at(self, fps: float) -> int:
        """Return how many frames the motion has at another rate, as `resample` makes them."""
        return int(np.floor(self.duration * fps + 1e-6)) + 1

    def save_npz(self, path: Path) -> None:
        """Write fps, joint_names, root, rotations and positions."""
        np.savez_compressed(
            path,
            fps=self.fps,
            joint_names=np.array(self.skeleton.names),
            root=self.root.astype(np.float32),
            rotations=self.rotations.astype(np.float32),
            positions=self.positions.astype(np.float32),
        )

    @classmethod
    def load_npz(cls, path: Path) -> Motion:
        """Read what `save_npz` wrote.

        Raises:
            MotionFileError: If the file is not such an archive of the canonical joints.
        """
        try:
            with np.load(path, allow_pickle=False) as data:
                names = tuple(str(n) for n in data["joint_names"])
                root, rotations = data["root"].astype(float), data["rotations"].astype(float)
                fps = float(data["fps"])
        except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
            raise MotionFileError(f"{path}: not a motion archive ({error})") from error
        if names != CANONICAL.names:
            raise MotionFileError(f"{path}: joints {names} are not the canonical {CANONICAL.names}")
        if not (np.isfinite(root).all() and np.isfinite(rotations).all()):
            raise MotionFileError(f"{path}: root or rotations hold values that are not finite")
        try:
            return cls(root, rot.normalise(rotations), fps)
        except ValueError as error:
            raise MotionFileError(f"{path}: {error}") from error
