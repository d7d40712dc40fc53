"""MuJoCo's pictures where a GL works; a clear error where none does."""

import numpy as np
import pytest
from PIL import Image, ImageSequence
from synthetic import waving

from motiondiffuse_ros.errors import PhysicsError
from motiondiffuse_ros.physics.humanoid import humanoid_model
from motiondiffuse_ros.physics.state import motion_to_qpos
from motiondiffuse_ros.render.mujoco_renderer import render_qpos

QPOS = motion_to_qpos(waving(8))


def test_a_film_shows_the_humanoid_or_the_reason_why_not(tmp_path):
    try:
        path = render_qpos(humanoid_model(), QPOS, 20.0, tmp_path / "a.gif", size=(160, 128))
    except PhysicsError as error:
        pytest.skip(f"no GL here: {error}")
    with Image.open(path) as film:
        assert len(list(ImageSequence.Iterator(film))) == 8
        colours = np.asarray(film.convert("RGB")).reshape(-1, 3).astype(int)
    blue, orange = np.array([40, 120, 214]), np.array([235, 104, 52])
    for limb in (blue, orange):
        assert (np.abs(colours - limb).sum(axis=1) < 150).sum() > 20


def test_a_gl_that_is_not_there_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "nonsense")
    with pytest.raises(PhysicsError, match="nonsense"):
        render_qpos(humanoid_model(), QPOS, 20.0, tmp_path / "a.gif")


def test_an_unknown_kind_of_film_is_refused(tmp_path):
    with pytest.raises(PhysicsError, match=r"\.gif or an \.mp4"):
        render_qpos(humanoid_model(), QPOS, 20.0, tmp_path / "a.avi")
