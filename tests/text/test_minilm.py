import pytest
import torch

from motiondiffuse_ros.errors import TextEncoderError
from motiondiffuse_ros.text import load_text_encoder


@pytest.fixture(scope="module")
def minilm():
    return load_text_encoder("minilm")


def test_token_states_tell_left_from_right(minilm):
    states = minilm.encode(["a person raises the left hand", "a person raises the right hand"])
    left, right = states.states
    closeness = torch.cosine_similarity(left, right, dim=-1)
    # [CLS] a person raises the LEFT hand [SEP]
    assert closeness.argmin() == 5
    assert closeness[5] < 0.9


def test_a_sentence_is_the_same_alone_and_beside_a_longer_one(minilm):
    texts = ["bow", "a person walks in a circle and then sits down on a chair"]
    both, alone = minilm.encode(texts), minilm.encode(texts[:1])
    length = int(alone.mask.sum())
    torch.testing.assert_close(both.states[0, :length], alone.states[0], atol=1e-4, rtol=1e-3)
    assert int(both.mask[0].sum()) == length
    assert not both.states[0, length:].any()


def test_the_empty_text_has_states(minilm):
    assert minilm.encode([""]).mask.sum() == 2  # start and end


def test_unknown_encoders_are_refused_with_the_known(tmp_path):
    with pytest.raises(TextEncoderError, match="minilm, clip"):
        load_text_encoder("word2vec")
    with pytest.raises(TextEncoderError, match="needs the folder"):
        load_text_encoder("clip")
    with pytest.raises(TextEncoderError, match="no CLIP"):
        load_text_encoder("clip", tmp_path)


def test_clip_loads_from_a_folder_in_its_layout(tmp_path):
    """With random weights of ViT-B/32's text shape: the real ones are the user's."""
    from transformers import CLIPTextConfig, CLIPTextModel, CLIPTokenizer

    vocabulary = {"<|startoftext|>": 0, "<|endoftext|>": 1, "a</w>": 2, "w": 3, "a": 4}
    import json

    (tmp_path / "vocab.json").write_text(json.dumps(vocabulary))
    (tmp_path / "merges.txt").write_text("#version: 0.2\n")
    CLIPTokenizer(
        str(tmp_path / "vocab.json"), str(tmp_path / "merges.txt"), model_max_length=77
    ).save_pretrained(tmp_path)
    config = CLIPTextConfig(
        vocab_size=5, num_hidden_layers=1, bos_token_id=0, eos_token_id=1, pad_token_id=1
    )
    CLIPTextModel(config).save_pretrained(tmp_path)
    encoder = load_text_encoder("clip", tmp_path)
    states = encoder.encode(["a", "a a a"])
    assert states.states.shape[-1] == encoder.dim == 512
    assert states.mask.sum(1).tolist() == [3, 5]
