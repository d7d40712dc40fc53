import pytest
from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.corpus.captions import (
    mirror_caption,
    read_captions,
    shipped_caption_files,
)
from motiondiffuse_ros.errors import CorpusError


@pytest.mark.parametrize(
    ("text", "mirrored"),
    [
        ("a person raises the left hand", "a person raises the right hand"),
        ("Left foot, then RIGHT foot", "Right foot, then LEFT foot"),
        ("turns clockwise", "turns counterclockwise"),
        ("a right-handed throw to the left", "a left-handed throw to the right"),
        ("the person leaves right away", "the person leaves right away"),
        ("a bright light", "a bright light"),
    ],
)
def test_sides_are_swapped_and_nothing_else(text, mirrored):
    assert mirror_caption(text) == mirrored


words = st.sampled_from(["left", "right", "Left", "walks", "to", "the", "leftward", "clockwise"])


@given(st.lists(words).map(" ".join))
def test_mirror_is_its_own_inverse(text):
    assert mirror_caption(mirror_caption(text)) == text


def test_every_shipped_caption_mirrors_back():
    captions = read_captions(shipped_caption_files())
    texts = {t for entry in captions.values() for t in entry}
    assert len(texts) > 5000
    odd = [t for t in texts if mirror_caption(mirror_caption(t)) != t]
    assert not odd


def test_a_bad_line_is_named(tmp_path):
    path = tmp_path / "c.jsonl"
    path.write_text('{"clip": "a", "captions": ["x"]}\n{"captions": []}\n')
    with pytest.raises(CorpusError, match=r"c\.jsonl, line 2"):
        read_captions([path])
