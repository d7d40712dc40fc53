"""The same sentences in a row are encoded once."""

import torch

from motiondiffuse_ros.text import load_text_encoder
from motiondiffuse_ros.text.remembered import Remembered


def test_the_last_answer_is_given_again_and_no_other():
    encoder = load_text_encoder("minilm")
    remembered = Remembered(encoder)
    first = remembered.encode(["bow"])
    assert remembered.encode(("bow",)) is first
    assert (remembered.name, remembered.sha256) == (encoder.name, encoder.sha256)
    both = remembered.encode(["bow", "wave with the right hand"])
    again = remembered.encode(["bow"])
    assert again is not first
    torch.testing.assert_close(again.states, first.states, rtol=0, atol=0)
    for asked, plain in ((both, ["bow", "wave with the right hand"]), (again, ["bow"])):
        torch.testing.assert_close(asked.states, encoder.encode(plain).states, rtol=0, atol=0)
