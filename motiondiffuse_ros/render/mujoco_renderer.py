"""States of a MuJoCo model as a film, on machines with and without a display."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
from PIL import Image

from motiondiffuse_ros.errors import PhysicsError
from motiondiffuse_ros.render.skeleton_renderer import save_gif

BACKENDS = ("egl", "osmesa")
"""What is tried, in this order, unless MUJOCO_GL says which."""

GIF_FPS, VIDEO_FPS = 20.0, 50.0
_TIMEOUT = 300.0


def render_qpos(
    model: mujoco.MjModel,
    qpos: np.ndarray,
    fps: float,
    path: Path,
    *,
    size: tuple[int, int] = (480, 400),
) -> Path:
    """Render states offscreen, the camera following the root.

    Args:
        model: Its first joint is the floating base; `scene=True` models have floor and light.
        qpos: States [T, nq].
        fps: States a second; the film leaves out states to stay under `GIF_FPS` or `VIDEO_FPS`.
        path: `.gif`, or `.mp4` where imageio-ffmpeg is installed.
        size: Width and height in pixels, multiples of 16 for video.

    Returns:
        The path.

    Raises:
        PhysicsError: If the suffix cannot be written here, or no GL backend works.
    """
    if path.suffix not in (".gif", ".mp4"):
        raise PhysicsError(f"{path}: a film is a .gif or an .mp4")
    video = path.suffix == ".mp4"
    if video and not find_spec("imageio_ffmpeg"):
        raise PhysicsError(f"{path}: an .mp4 needs imageio-ffmpeg (pip install imageio-ffmpeg)")
    shown_fps = min(fps, VIDEO_FPS if video else GIF_FPS)
    count = max(1, round(len(qpos) / fps * shown_fps))
    shown = qpos[np.minimum((np.arange(count) * fps / shown_fps).astype(int), len(qpos) - 1)]
    frames = render_states(model, shown, size)
    path.parent.mkdir(parents=True, exist_ok=True)
    if not video:
        return save_gif([Image.fromarray(frame) for frame in frames], path, shown_fps)
    _save_video(frames, path, shown_fps)
    return path


def render_states(model: mujoco.MjModel, qpos: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return pictures [T, height, width, 3] of states [T, nq]; see `render_qpos`."""
    chosen = os.environ.get("MUJOCO_GL")
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        files = [str(Path(folder) / name) for name in ("model.mjb", "qpos.npy", "frames.npy")]
        mujoco.mj_saveModel(model, files[0])
        np.save(files[1], np.asarray(qpos, dtype=np.float64))
        command = [sys.executable, "-m", "motiondiffuse_ros.render.offscreen", *files]
        for backend in (chosen,) if chosen else BACKENDS:
            try:
                done = subprocess.run(
                    [*command, *map(str, size)],
                    env={**os.environ, "MUJOCO_GL": backend, "PYTHONPATH": _python_path()},
                    capture_output=True,
                    text=True,
                    timeout=_TIMEOUT,
                    check=False,
                )
            except subprocess.TimeoutExpired:
                failures.append(f"{backend}: not done after {_TIMEOUT:.0f} s")
                continue
            if done.returncode == 0:
                return np.load(files[2])
            last = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
            failures.append(f"{backend}: {last[-1]}")
    raise PhysicsError(f"MuJoCo cannot render on this machine ({'; '.join(failures)})")


def _python_path() -> str:
    """Let the child find this package however this process found it."""
    return os.pathsep.join(entry for entry in sys.path if entry)


def _save_video(frames: np.ndarray, path: Path, fps: float) -> None:
    import imageio_ffmpeg  # pyright: ignore[reportMissingImports]

    height, width = frames.shape[1:3]
    writer = imageio_ffmpeg.write_frames(str(path), (width, height), fps=fps)
    writer.send(None)
    for frame in frames:
        writer.send(np.ascontiguousarray(frame))
    writer.close()
