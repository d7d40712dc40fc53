"""The picture of a verdict: drawn for any report, red where something fails."""

import numpy as np
import pytest
from PIL import Image
from synthetic import moved, standing, waving

from motiondiffuse_ros.physics import assess
from motiondiffuse_ros.render.verdict_sheet import draw_verdict, verdict_sheet

FAIL = (249, 213, 208)


def _share_failing(motion) -> np.ndarray:
    """Return which columns of the picture hold a failing span."""
    pixels = np.asarray(verdict_sheet(assess(motion, track=False)))
    return (pixels == FAIL).all(axis=-1).any(axis=0)


def test_a_plausible_motion_has_nothing_marked():
    assert not _share_failing(waving(60)).any()


def test_the_failing_span_is_marked_where_it_is():
    sunk = np.zeros((100, 3))
    sunk[50:, 2] = -0.1
    columns = np.flatnonzero(_share_failing(moved(standing(100), sunk)))
    assert columns.min() == pytest.approx((214 + 1176) / 2, abs=40)
    assert columns.max() > 1150


def test_it_is_written_as_png(tmp_path):
    path = tmp_path / "verdict.png"
    draw_verdict(assess(waving(40), track=False), path, "wave")
    with Image.open(path) as image:
        assert image.format == "PNG"
        assert image.width == 1200


def test_what_could_not_be_judged_has_its_reason_only():
    assert verdict_sheet(assess(standing(1))).height < 200
