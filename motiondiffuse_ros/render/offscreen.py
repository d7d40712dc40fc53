"""The child process of `mujoco_renderer`: run as a module with MUJOCO_GL set.

    python -m motiondiffuse_ros.render.offscreen MODEL.mjb QPOS.npy FRAMES.npy WIDTH HEIGHT

A GL library that does not fit the machine aborts the process that loads it, which must not be
the caller's.
"""

from __future__ import annotations

import sys

import mujoco
import numpy as np
from scipy.ndimage import uniform_filter1d

DISTANCE, AZIMUTH, ELEVATION = 3.4, 125.0, -12.0
_LOOK_AT_HEIGHT = 0.85
_SMOOTHED_FRAMES = 15


def render_frames(model: mujoco.MjModel, qpos: np.ndarray, width: int, height: int) -> np.ndarray:
    """Return pictures [N, height, width, 3] of states [N, nq], the camera following the root."""
    data = mujoco.MjData(model)
    camera = mujoco.MjvCamera()
    camera.distance, camera.azimuth, camera.elevation = DISTANCE, AZIMUTH, ELEVATION
    followed = uniform_filter1d(qpos[:, :2], min(_SMOOTHED_FRAMES, len(qpos)), axis=0)
    frames = np.empty((len(qpos), height, width, 3), dtype=np.uint8)
    with mujoco.Renderer(model, height, width) as renderer:
        for index, state in enumerate(qpos):
            data.qpos[:] = state
            mujoco.mj_forward(model, data)
            camera.lookat[:] = (*followed[index], _LOOK_AT_HEIGHT)
            renderer.update_scene(data, camera)
            renderer.render(out=frames[index])
    return frames


def main(arguments: list[str]) -> None:
    """Render what the arguments name."""
    model_path, qpos_path, frames_path, width, height = arguments
    model = mujoco.MjModel.from_binary_path(model_path)
    np.save(frames_path, render_frames(model, np.load(qpos_path), int(width), int(height)))


if __name__ == "__main__":
    main(sys.argv[1:])
