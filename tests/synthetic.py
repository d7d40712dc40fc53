"""Motions for tests: made of formulas, so that what is true of them is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.skeleton import STANDING_HEIGHT

FPS = 20.0


def turned(rotations: np.ndarray, joint: str, axis: int, angle) -> None:
    """Append a rotation about a coordinate axis to one joint, in place."""
    j = CANONICAL.index(joint)
    angles = np.broadcast_to(angle, len(rotations))
    rotations[:, j] = rot.multiply(rotations[:, j], rot.about_axis(axis, angles))


def standing(frames: int = 60, fps: float = FPS) -> Motion:
    """Stand still on the floor with hanging arms."""
    rotations = rot.identity(frames, len(CANONICAL.names))
    turned(rotations, "left_shoulder", 0, -1.3)
    turned(rotations, "right_shoulder", 0, 1.3)
    root = np.tile([0.0, 0.0, STANDING_HEIGHT], (frames, 1))
    return Motion(root, rotations, fps)


def waving(frames: int = 60, fps: float = FPS) -> Motion:
    """Stand and wave the right forearm, level upper arm."""
    still = standing(frames, fps)
    rotations = still.rotations.copy()
    turned(rotations, "right_shoulder", 0, -1.3)
    turned(rotations, "right_elbow", 2, 1.2 + 0.5 * np.sin(6.0 * np.arange(frames) / fps))
    return Motion(still.root, rotations, fps)


def jumping_jack(times: int, arms: float = 1.0, legs: float = 1.0) -> Motion:
    """Stand, and bring arms up and legs apart and back, once a second, in shares of all the way."""
    still = standing(round(times * FPS) + 1)
    rotations = still.rotations.copy()
    out = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(still.frames) / FPS)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        turned(rotations, f"{side}_shoulder", 0, 2.6 * sign * arms * out)
        turned(rotations, f"{side}_hip", 0, 0.4 * sign * legs * out)
    return Motion(still.root, rotations, FPS)


@st.composite
def smooth_motions(draw: st.DrawFn, max_amplitude: float = 1.2) -> Motion:
    """Any smooth motion: a few sines a joint about random axes, 1 to 80 frames."""
    seed = draw(st.integers(0, 2**32 - 1))
    frames = draw(st.integers(1, 80))
    fps = draw(st.sampled_from([20.0, 24.0, 30.0]))
    amplitude = draw(st.floats(0.0, max_amplitude))
    rng = np.random.default_rng(seed)
    times = np.arange(frames)[:, None, None] / fps
    joints = len(CANONICAL.names)
    frequency, phase = rng.uniform(0, 2.0, (2, joints, 3)) * np.array([[[1.0]], [[np.pi]]])
    vectors = (
        amplitude * rng.normal(size=(joints, 3)) * np.sin(2 * np.pi * frequency * times + phase)
    )
    path = np.cumsum(rng.normal(size=(frames, 3)) * 0.01, axis=0)
    return Motion(path + np.array([0.0, 0.0, 1.0]), rot.from_rotation_vector(vectors), fps)


def moved(motion: Motion, by: np.ndarray) -> Motion:
    """Add a displacement [3] or [T, 3], m, to the path of the root."""
    return replace(motion, root=motion.root + by)


def drifting(motion: Motion, speed: float) -> Motion:
    """Let the whole body glide forward at a speed [m/s]."""
    times = np.arange(motion.frames)[:, None] / motion.fps
    return moved(motion, times * np.array([speed, 0.0, 0.0]))
