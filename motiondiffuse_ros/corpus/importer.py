"""From a BVH file of a known skeleton map to a canonical `Motion`."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from motiondiffuse_ros.corpus.skeleton_map import (
    SkeletonMap,
    match_skeleton_map,
    shipped_skeleton_maps,
)
from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.bvh import BvhClip, read_bvh
from motiondiffuse_ros.motion.frames import (
    quaternions_to_z_up,
    vectors_to_y_up,
    vectors_to_z_up,
)
from motiondiffuse_ros.motion.from_positions import root_under_hips
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import ANKLE_HEIGHT, LEG_LENGTH, TOE_HEIGHT

_FLOOR_PERCENTILE = 5.0
_shipped = cache(shipped_skeleton_maps)


def load_motion(path: Path, skeleton_map: SkeletonMap | None = None) -> Motion:
    """Read a BVH file as a canonical motion with its floor at z = 0.

    Args:
        path: The file.
        skeleton_map: How to read its joints; None chooses among the shipped maps.

    Raises:
        MotionFileError: If the file is broken or no map fits.
    """
    clip = read_bvh(path)
    maps = _shipped() if skeleton_map is None else (skeleton_map,)
    chosen = match_skeleton_map(clip.names, path, maps)
    motion = retarget_clip(clip, chosen)
    if motion.frames <= chosen.skip_frames:
        raise MotionFileError(f"{path}: no frames after the first {chosen.skip_frames}")
    motion = motion.slice(chosen.skip_frames, motion.frames)
    return on_floor(motion) if chosen.find_floor else motion


def retarget_clip(clip: BvhClip, skeleton_map: SkeletonMap) -> Motion:
    """Carry world rotations over to the canonical skeleton; the file's frame rate and floor.

    Each canonical joint takes the world rotation of its source times the inverse of the source's
    T-pose rotation. The path is that of the middle of the hips, scaled by leg length.
    """
    index = {name: j for j, name in enumerate(clip.names)}
    world = np.empty((len(clip.rotations), len(CANONICAL.names), 4))
    for j, (name, parent) in enumerate(zip(CANONICAL.names, CANONICAL.parents, strict=True)):
        sources = skeleton_map.joints.get(name)
        if sources is None:
            world[:, j] = world[:, parent]
            continue
        turned = [_from_t_pose(clip, index[s], s, skeleton_map) for s in sources]
        world[:, j] = turned[0] if len(turned) == 1 else rot.slerp(turned[0], turned[-1], 0.5)
        if name in skeleton_map.follow_bones:
            world[:, j] = rot.multiply(world[:, j], _bone_correction(clip, j, skeleton_map))
    world = rot.normalise(quaternions_to_z_up(world))

    hips = [index[skeleton_map.joints[f"{side}_hip"][0]] for side in ("left", "right")]
    scale = LEG_LENGTH / _leg_length(clip, skeleton_map)
    middle = vectors_to_z_up(clip.positions[:, hips].mean(axis=1)) * scale
    root = root_under_hips(middle, world[:, 0])
    return Motion(root, CANONICAL.local_rotations(world), 1.0 / clip.frame_time)


def _from_t_pose(clip: BvhClip, j: int, name: str, skeleton_map: SkeletonMap) -> Array:
    world = clip.global_rotations[:, j]
    t_pose = skeleton_map.t_pose.get(name)
    return world if t_pose is None else rot.multiply(world, rot.conjugate(t_pose))


def _bone_correction(clip: BvhClip, joint: int, skeleton_map: SkeletonMap) -> Array:
    """Return the rotation that takes the canonical bone to the file's, both in the T-pose."""
    child = CANONICAL.parents.index(joint)
    (source,) = skeleton_map.joints[CANONICAL.names[joint]]
    (tip,) = skeleton_map.joints[CANONICAL.names[child]]
    offset = clip.offsets[clip.names.index(tip)]
    if (t_pose := skeleton_map.t_pose.get(source)) is not None:
        offset = rot.rotate(t_pose, offset)
    return rot.shortest_arc(vectors_to_y_up(CANONICAL.offsets[child]), offset)


def _leg_length(clip: BvhClip, skeleton_map: SkeletonMap) -> float:
    """Return the file's hip-to-ankle length, mean of both sides, in file units."""
    lengths = [
        np.linalg.norm(clip.offsets[clip.names.index(skeleton_map.joints[f"{side}_{joint}"][0])])
        for side in ("left", "right")
        for joint in ("knee", "ankle")
    ]
    return float(sum(lengths)) / 2.0


def on_floor(motion: Motion) -> Motion:
    """Return the motion with the floor its feet stand on at z = 0."""
    return motion.with_root(motion.root - [0.0, 0.0, floor_height(motion)])


def floor_height(motion: Motion) -> float:
    """Estimate the height [m] on which a clip's feet stand.

    The low percentile, over frames, of the lowest sole: robust to a single bad frame, and right
    for a clip that is mostly in the air only if it lands at least now and then.
    """
    heels = [CANONICAL.index("left_ankle"), CANONICAL.index("right_ankle")]
    toes = [CANONICAL.index("left_foot"), CANONICAL.index("right_foot")]
    z = motion.positions[..., 2]
    soles = np.concatenate([z[:, heels] - ANKLE_HEIGHT, z[:, toes] - TOE_HEIGHT], axis=1)
    return float(np.percentile(soles.min(axis=1), _FLOOR_PERCENTILE))
