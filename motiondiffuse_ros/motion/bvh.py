"""Biovision hierarchy (BVH) files: reading any, writing canonical motions."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.frames import (
    quaternions_to_y_up,
    vectors_to_y_up,
)
from motiondiffuse_ros.motion.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import Skeleton

_AXES = {"X": 0, "Y": 1, "Z": 2}
_END_SITE = "End Site"


@dataclass(frozen=True, eq=False)
class BvhClip:
    """A BVH file as it stands: its own joints, units and axes.

    Attributes:
        names: Joint names, parents first; end sites are not joints.
        parents: Index of each joint's parent, -1 for the root.
        offsets: Offset of each joint from its parent [J, 3], file units.
        end_sites: Offset of the end site of each leaf joint that has one.
        translations: Position of each joint in its parent's frame per frame [T, J, 3].
        rotations: Local rotations [T, J, 4], wxyz.
        frame_time: Seconds per frame.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array = field(repr=False)
    end_sites: dict[str, Array] = field(repr=False)
    translations: Array = field(repr=False)
    rotations: Array = field(repr=False)
    frame_time: float

    @cached_property
    def global_rotations(self) -> Array:
        """World rotations [T, J, 4]."""
        return Skeleton(self.names, self.parents, self.offsets).global_rotations(self.rotations)

    @cached_property
    def positions(self) -> Array:
        """World positions [T, J, 3], file units."""
        out = np.empty_like(self.translations)
        for j, p in enumerate(self.parents):
            step = self.translations[:, j]
            out[:, j] = step if p < 0 else out[:, p] + rot.rotate(self.global_rotations[:, p], step)
        return out


@dataclass
class _Hierarchy:
    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[list[float]] = field(default_factory=list)
    channels: list[list[str]] = field(default_factory=list)
    end_sites: dict[str, Array] = field(default_factory=dict)


def read_bvh(path: Path) -> BvhClip:
    """Read a BVH file.

    Args:
        path: The file.

    Raises:
        MotionFileError: If the file is missing, truncated or not BVH; the message says where.
    """
    try:
        text = Path(path).read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise MotionFileError(f"{path}: cannot be read ({error.strerror})") from error
    head, marker, motion = text.partition("MOTION")
    if not head.lstrip().startswith("HIERARCHY") or not marker:
        raise MotionFileError(f"{path}: not a BVH file: no HIERARCHY and MOTION sections")
    tree = _parse_hierarchy(head.split()[1:], path)
    frames, frame_time, values = _parse_motion(motion, path)
    width = sum(len(c) for c in tree.channels)
    if frames < 1 or values.size != frames * width:
        raise MotionFileError(
            f"{path}: {frames} frames of {width} channels need {frames * width} numbers, "
            f"found {values.size}: truncated or altered"
        )
    if not np.isfinite(values).all():
        raise MotionFileError(f"{path}: motion values that are not finite")
    translations, rotations = _split_channels(tree, values.reshape(frames, width))
    return BvhClip(
        tuple(tree.names),
        tuple(tree.parents),
        np.array(tree.offsets),
        tree.end_sites,
        translations,
        rotations,
        frame_time,
    )


def _parse_hierarchy(tokens: list[str], path: Path) -> _Hierarchy:
    tree = _Hierarchy()
    stack: list[int | None] = []  # None stands for an end site
    pending: int | None = None
    i = 0
    try:
        while i < len(tokens):
            token = tokens[i]
            if token in ("ROOT", "JOINT"):
                name = tokens[i + 1]
                if name in tree.names:
                    raise MotionFileError(f"{path}: joint '{name}' stands twice in the hierarchy")
                tree.names.append(name)
                tree.parents.append(next((s for s in reversed(stack) if s is not None), -1))
                tree.offsets.append([0.0, 0.0, 0.0])
                tree.channels.append([])
                pending = len(tree.names) - 1
                i += 2
            elif token == "End":
                pending = None
                i += 2
            elif token == "{":
                stack.append(pending)
                i += 1
            elif token == "}":
                stack.pop()
                i += 1
            elif token == "OFFSET":
                offset = [float(x) for x in tokens[i + 1 : i + 4]]
                joint = stack[-1]
                if joint is None:
                    parent = next(s for s in reversed(stack) if s is not None)
                    tree.end_sites[tree.names[parent]] = np.array(offset)
                else:
                    tree.offsets[joint] = offset
                i += 4
            elif token == "CHANNELS":
                count = int(tokens[i + 1])
                joint = stack[-1]
                assert joint is not None
                tree.channels[joint] = tokens[i + 2 : i + 2 + count]
                i += 2 + count
            else:
                raise MotionFileError(f"{path}: unexpected '{token}' in the hierarchy")
    except (IndexError, ValueError, AssertionError, StopIteration) as error:
        raise MotionFileError(f"{path}: the hierarchy is broken near token {i}") from error
    if stack or not tree.names:
        raise MotionFileError(f"{path}: the hierarchy has unbalanced braces or no joint")
    known = {f"{a}{kind}" for a in _AXES for kind in ("position", "rotation")}
    for name, channels in zip(tree.names, tree.channels, strict=True):
        if not set(channels) <= known:
            raise MotionFileError(f"{path}: joint '{name}' has unknown channels {channels}")
    return tree


def _parse_motion(text: str, path: Path) -> tuple[int, float, Array]:
    lines = text.lstrip().split("\n", 2)
    try:
        frames = int(lines[0].split(":")[1])
        frame_time = float(lines[1].split(":")[1])
    except (IndexError, ValueError) as error:
        raise MotionFileError(f"{path}: no 'Frames:' and 'Frame Time:' after MOTION") from error
    if not (np.isfinite(frame_time) and frame_time > 0):
        raise MotionFileError(f"{path}: frame time {frame_time} s is not positive")
    try:
        values = np.array(lines[2].split() if len(lines) > 2 else [], dtype=np.float64)
    except ValueError as error:
        raise MotionFileError(f"{path}: motion data is not numbers ({error})") from error
    return frames, frame_time, values


def _split_channels(tree: _Hierarchy, values: Array) -> tuple[Array, Array]:
    frames = len(values)
    translations = np.tile(np.array(tree.offsets), (frames, 1, 1))
    rotations = rot.identity(frames, len(tree.names))
    column = 0
    for j, channels in enumerate(tree.channels):
        for channel in channels:
            axis = _AXES[channel[0]]
            if channel.endswith("position"):
                translations[:, j, axis] = values[:, column]
            else:
                turn = rot.about_axis(axis, np.radians(values[:, column]))
                rotations[:, j] = rot.multiply(rotations[:, j], turn)
            column += 1
    return translations, rotations


def write_bvh(motion: Motion, path: Path) -> None:
    """Write a motion in cm, y up, facing +z, rotation order ZXY, under its own joint names."""
    skeleton = motion.skeleton
    offsets = vectors_to_y_up(skeleton.offsets) * 100.0
    euler = _euler_zxy(quaternions_to_y_up(motion.rotations))
    order: list[int] = []
    lines = ["HIERARCHY"]

    def emit(joint: int, depth: int) -> None:
        pad = "\t" * depth
        order.append(joint)
        lines.append(f"{pad}{'JOINT' if depth else 'ROOT'} {skeleton.names[joint]}")
        lines.append(f"{pad}{{")
        lines.append(f"{pad}\tOFFSET " + " ".join(f"{x:.6f}" for x in offsets[joint]))
        position = "6 Xposition Yposition Zposition" if depth == 0 else "3"
        lines.append(f"{pad}\tCHANNELS {position} Zrotation Xrotation Yrotation")
        children = [c for c, p in enumerate(skeleton.parents) if p == joint]
        for child in children:
            emit(child, depth + 1)
        if not children:
            tip = 0.25 * offsets[joint]
            lines.extend([f"{pad}\t{_END_SITE}", f"{pad}\t{{"])
            lines.append(f"{pad}\t\tOFFSET " + " ".join(f"{x:.6f}" for x in tip))
            lines.append(f"{pad}\t}}")
        lines.append(f"{pad}}}")

    emit(0, 0)
    root = vectors_to_y_up(motion.root) * 100.0
    rows = np.concatenate([root, euler[:, order].reshape(motion.frames, -1)], axis=1)
    lines += ["MOTION", f"Frames: {motion.frames}", f"Frame Time: {1.0 / motion.fps:.8f}"]
    lines += [" ".join(f"{x:.6f}" for x in row) for row in rows]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def _euler_zxy(q: Array) -> Array:
    """Return angles [..., 3] in degrees with R = Rz Rx Ry."""
    m = rot.to_matrix(q)
    x = np.arcsin(np.clip(m[..., 2, 1], -1.0, 1.0))
    z = np.arctan2(-m[..., 0, 1], m[..., 1, 1])
    y = np.arctan2(-m[..., 2, 0], m[..., 2, 2])
    return np.degrees(np.stack([z, x, y], axis=-1))
