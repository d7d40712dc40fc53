"""What a simulated robot did, as a picture that moves, with or without GL."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from motiondiffuse_ros.errors import PhysicsError
from motiondiffuse_ros.physics.state import qpos_to_motion
from motiondiffuse_ros.render.mujoco_renderer import render_qpos
from motiondiffuse_ros.render.skeleton_renderer import render_skeleton
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.robots.simulation import ExecutedMotion


def render_executed_motion(executed: ExecutedMotion, stem: Path) -> Path:
    """Render with MuJoCo where it can open a GL context, and draw the skeleton otherwise.

    Args:
        executed: Of the humanoid, or of any robot where there is GL.
        stem: Path without suffix; .mp4 is added where imageio-ffmpeg is installed, else .gif.

    Returns:
        The file.
    """
    suffix = ".mp4" if find_spec("imageio_ffmpeg") else ".gif"
    model = get_robot(executed.robot).model
    try:
        return render_qpos(model, executed.qpos, executed.fps, stem.with_suffix(suffix))
    except PhysicsError:
        motions = [qpos_to_motion(q, executed.fps) for q in (executed.reference, executed.qpos)]
        return render_skeleton(motions, stem.with_suffix(".gif"), titles=("planned", "executed"))
