"""Pictures hold what they should: as many frames and rows as asked, left and right apart."""

import numpy as np
import pytest
from PIL import Image, ImageSequence
from synthetic import standing, waving

from motiondiffuse_ros.render import contact_sheet, render_skeleton


def test_a_gif_has_the_duration_of_the_longest_motion(tmp_path):
    path = render_skeleton(
        [standing(21), waving(41)], tmp_path / "new" / "a.gif", titles=["stands", "waves"], fps=10
    )
    with Image.open(path) as gif:
        assert len(list(ImageSequence.Iterator(gif))) == 21
        assert gif.info["duration"] == 100


def test_what_moves_changes_from_frame_to_frame(tmp_path):
    path = render_skeleton([standing(21), waving(21)], tmp_path / "a.gif")
    with Image.open(path) as gif:
        first = np.asarray(gif.convert("RGB")).astype(int)
        gif.seek(15)
        later = np.asarray(gif.convert("RGB")).astype(int)
    middle = first.shape[1] // 2
    # below the title, above the clock
    change = np.abs(first - later)[30:-30].sum(axis=(0, 2))
    assert change[:middle].sum() < 0.02 * change[middle:].sum()


def test_a_sheet_grows_by_rows_and_columns(tmp_path):
    rows = [("stands", standing(20)), ("waves", waving(20))]
    wide = Image.open(contact_sheet(rows, tmp_path / "wide.png", columns=8)).size
    small = Image.open(contact_sheet(rows[:1], tmp_path / "small.png", columns=4)).size
    assert wide == (2 * small[0], 2 * small[1])


@pytest.mark.parametrize("titles", [["one"], ["one", "two", "three"]])
def test_titles_must_be_as_many_as_motions(tmp_path, titles):
    with pytest.raises(ValueError, match="2 motions"):
        render_skeleton([standing(3), standing(3)], tmp_path / "a.gif", titles=titles)
