import numpy as np
import torch

from motiondiffuse_ros.corpus.statistics import Statistics
from motiondiffuse_ros.diffusion.constraints import Eased, KeptFeatures, OnPlainFeatures, apply

FRAMES = 40


def _eased(values, clean, kept, frames=10):
    rows = torch.zeros(FRAMES, dtype=torch.bool)
    rows[kept] = True
    mask = rows[:, None].float().expand_as(values)
    return apply([Eased(values, rows, frames), KeptFeatures(values, mask)], clean)


def test_free_frames_go_on_from_kept_ones_on_both_sides():
    time = torch.arange(FRAMES)[:, None] / FRAMES
    values = 1.0 + time.expand(FRAMES, 3)
    clean = torch.sin(3.0 * time).expand(2, FRAMES, 3)
    out = _eased(values, clean, slice(15, 20))
    assert torch.equal(out[:, 15:20], values[15:20].expand(2, 5, 3))
    # neither a jump nor a kink: no step is far from the one before
    steps = out[0, :, 0].diff()
    assert steps.diff().abs().max() < 0.06
    # away from the kept frames the prediction is left alone
    assert torch.equal(out[:, 30:], clean[:, 30:])
    assert torch.equal(out[:, :5], clean[:, :5])


def test_what_agrees_is_left_alone():
    values = torch.randn(FRAMES, 3, generator=torch.Generator().manual_seed(0))
    out = _eased(values, values[None], slice(0, 12))
    torch.testing.assert_close(out[0], values)


def test_kept_spans_near_each_other_are_kept():
    values = torch.ones(FRAMES, 3)
    rows = torch.zeros(FRAMES, dtype=torch.bool)
    rows[:10] = rows[13:20] = rows[-1] = True
    clean = torch.zeros(1, FRAMES, 3)
    out = Eased(values, rows, 10)(clean)
    assert torch.equal(out[:, rows], clean[:, rows])
    assert torch.isfinite(out).all()


def test_a_constraint_can_be_put_in_plain_numbers():
    rng = np.random.default_rng(0)
    statistics = Statistics(rng.normal(size=3).astype("f"), rng.uniform(0.5, 2, 3).astype("f"))
    seen = []

    def doubled(plain):
        seen.append(plain.numpy())
        return 2.0 * plain

    clean = torch.from_numpy(rng.normal(size=(2, 5, 3)).astype("f"))
    out = OnPlainFeatures(doubled, statistics)(clean).numpy()
    np.testing.assert_allclose(seen[0], statistics.denormalise(clean.numpy()), rtol=1e-5)
    np.testing.assert_allclose(statistics.denormalise(out), 2.0 * seen[0], rtol=1e-4, atol=1e-5)
