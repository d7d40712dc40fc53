"""Windows that each predict a constant, so that what becomes of them is known."""

import numpy as np
import pytest
import torch

from motiondiffuse_ros.diffusion.composition import TimedText, compose
from motiondiffuse_ros.diffusion.constraints import KeptFeatures
from motiondiffuse_ros.diffusion.windowed_prediction import WindowedPrediction
from motiondiffuse_ros.motion.features import PoseState

STATE = PoseState()
FRAMES = 60


def _predict(texts, values, *, part_correction=0.0, time_correction=0.0, frames=FRAMES):
    windows = compose(tuple(texts), frames, STATE, max_frames=196, blend_frames=10)
    of_text = dict(zip([t.text for t in texts], values, strict=True))
    constants = torch.tensor([of_text[w.text] for w in windows])
    predict = WindowedPrediction(
        lambda noisy, step, lengths, rows: constants[rows][:, None, None].expand_as(noisy),
        windows,
        part_correction=part_correction,
        time_correction=time_correction,
        device=torch.device("cpu"),
    )
    return predict(torch.zeros(2, frames, STATE.dim), 500)


ON_PARTS = (
    TimedText("walk", 0, FRAMES),
    TimedText("wave", 0, FRAMES, ("right_arm",)),
)
IN_TIME = (TimedText("walk", 0, 30), TimedText("run", 30, FRAMES))


def test_hard_masks_give_every_part_its_own_text():
    out = _predict(ON_PARTS, [1.0, 3.0])
    arm = STATE.part_indices("right_arm")
    assert (out[:, :, arm] == 3.0).all()
    assert (np.delete(out.numpy(), arm, axis=2) == 1.0).all()


def test_the_correction_draws_parts_together_evenly():
    arm = STATE.part_indices("right_arm")
    for amount in (0.25, 0.5, 1.0):
        out = _predict(ON_PARTS, [1.0, 3.0], part_correction=amount)
        torch.testing.assert_close(out[:, :, arm], torch.full_like(out[:, :, arm], 3.0 - amount))
        legs = out[:, :, STATE.part_indices("legs")]
        torch.testing.assert_close(legs, torch.full_like(legs, 1.0 + amount))


def test_the_correction_in_time_stays_inside_the_overlap():
    plain = _predict(IN_TIME, [1.0, 3.0])
    drawn = _predict(IN_TIME, [1.0, 3.0], time_correction=1.0)
    changed = (plain != drawn).any(dim=2)[0].nonzero()[:, 0]
    assert changed.min() >= 25
    assert changed.max() < 35
    # nearer to the mean, and no step where the overlap begins
    assert ((drawn - 2.0).abs() <= (plain - 2.0).abs() + 1e-6).all()
    assert drawn[0, :, 0].diff().abs().max() < 0.6


def test_each_correction_is_for_its_own_kind():
    assert torch.equal(
        _predict(ON_PARTS, [1.0, 3.0], time_correction=1.0), _predict(ON_PARTS, [1.0, 3.0])
    )
    assert torch.equal(
        _predict(IN_TIME, [1.0, 3.0], part_correction=1.0), _predict(IN_TIME, [1.0, 3.0])
    )


@pytest.mark.parametrize("amount", [0.0, 0.5, 1.0])
def test_windows_that_agree_are_left_alone(amount):
    texts = (*IN_TIME, TimedText("wave", 10, 50, ("left_arm", "head")))
    out = _predict(texts, [2.0] * 3, part_correction=amount, time_correction=amount)
    torch.testing.assert_close(out, torch.full_like(out, 2.0))


def test_given_features_replace_what_was_predicted():
    mask = torch.zeros(4, 3)
    mask[0], mask[1] = 1.0, 0.5
    clean = torch.randn(2, 4, 3, generator=torch.Generator().manual_seed(0))
    kept = KeptFeatures(torch.full((4, 3), 5.0), mask)(clean)
    assert (kept[:, 0] == 5.0).all()
    torch.testing.assert_close(kept[:, 1], 0.5 * (clean[:, 1] + 5.0))
    assert torch.equal(kept[:, 2:], clean[:, 2:])
