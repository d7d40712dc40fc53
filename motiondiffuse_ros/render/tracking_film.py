"""An executed motion beside the motion that it followed, as a film."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np

from motiondiffuse_ros.errors import PhysicsError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.humanoid import build_humanoid
from motiondiffuse_ros.physics.state import motion_to_qpos
from motiondiffuse_ros.render.mujoco_renderer import render_qpos
from motiondiffuse_ros.render.skeleton_renderer import render_skeleton

_ASIDE = 1.2  # of the reference, to the left of where it first looks [m]
_PALE = 0.4


def render_tracking(reference: Motion, executed: Motion, stem: Path) -> Path:
    """Render both bodies with MuJoCo where it can open a GL context, and draw them otherwise.

    Args:
        reference: What was asked for; the paler body.
        executed: At the same rate; if it ended early, in a fall, its last pose stays.
        stem: Path without suffix; .mp4 is added where imageio-ffmpeg is installed, else .gif.

    Returns:
        The file.
    """
    suffix = ".mp4" if find_spec("imageio_ffmpeg") else ".gif"
    wanted, done = motion_to_qpos(reference), motion_to_qpos(executed)
    done = done[np.minimum(np.arange(len(wanted)), len(done) - 1)]
    heading = reference.heading[0]
    wanted[:, :2] += _ASIDE * np.array([-np.sin(heading), np.cos(heading)])
    both = np.concatenate([done, wanted], axis=1)
    try:
        return render_qpos(
            _two_bodies(), both, reference.fps, stem.with_suffix(suffix), size=(640, 400)
        )
    except PhysicsError:
        return render_skeleton(
            [reference, executed], stem.with_suffix(".gif"), titles=("reference", "executed")
        )


def _two_bodies() -> mujoco.MjModel:
    spec, other = build_humanoid(scene=True), build_humanoid()
    for geom in other.geoms:
        geom.rgba[3] = _PALE
    spec.attach(other, prefix="reference_", frame=spec.worldbody.add_frame())
    return spec.compile()
