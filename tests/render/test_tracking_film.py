"""A film of tracking lasts as long as what was asked for, also after a fall."""

from PIL import Image, ImageSequence
from synthetic import standing, waving

from motiondiffuse_ros.render.tracking_film import render_tracking


def test_a_fall_leaves_the_last_pose(tmp_path, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "nonsense")
    path = render_tracking(waving(21), standing(11), tmp_path / "new" / "film")
    assert path == tmp_path / "new" / "film.gif"
    with Image.open(path) as film:
        assert len(list(ImageSequence.Iterator(film))) == 21


def test_where_there_is_gl_both_bodies_are_seen(tmp_path):
    path = render_tracking(waving(9), standing(5), tmp_path / "film")
    assert path.suffix in (".gif", ".mp4")
    assert path.stat().st_size > 1000
