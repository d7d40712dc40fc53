import pytest
import torch

from motiondiffuse_ros.evaluation.evaluator import Evaluator, critic_of
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.text import load_text_encoder
from motiondiffuse_ros.training.alignment import TextAlignment

TEXTS = ["a person waves with the left hand", "a person waves with the right hand", ""]


@pytest.fixture(scope="module")
def alignment():
    critic = Evaluator.from_pretrained(critic_of(shipped_weights()), load_text_encoder("minilm"))
    return TextAlignment(critic, TEXTS, time_width=256)


def test_following_its_gradient_separates_left_from_right(alignment):
    pooled = torch.zeros(2, 256, requires_grad=True)
    optimizer = torch.optim.Adam([pooled], lr=0.2)
    for _ in range(300):
        loss = alignment(pooled, TEXTS[:2])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    assert loss.item() < 1e-3
    assert alignment(pooled.flip(0), TEXTS[:2]).item() > 0.1


def test_the_empty_text_is_left_alone(alignment):
    pooled = torch.randn(1, 256, requires_grad=True)
    loss = alignment(pooled, [""])
    loss.backward()
    assert loss.item() == 0.0
    assert pooled.grad is not None
    assert not pooled.grad.any()
