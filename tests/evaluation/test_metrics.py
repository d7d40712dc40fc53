import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from motiondiffuse_ros.evaluation.metrics import (
    Estimate,
    diversity,
    frechet_distance,
    multimodality,
    pools,
    retrieval,
)

SETS = arrays(np.float64, st.tuples(st.integers(8, 30), st.just(3)), elements=st.floats(-5, 5))


def test_right_answers_that_are_nearest_have_full_precision():
    motion = np.eye(32)
    tops, distance = retrieval(motion, motion)
    assert tops.tolist() == [1.0, 1.0, 1.0]
    assert distance == 0.0


def test_an_evaluator_that_sees_no_difference_scores_nothing():
    same = np.ones((32, 4))
    assert retrieval(same, same)[0].tolist() == [0.0, 0.0, 0.0]


def test_precision_counts_how_many_motions_are_nearer_than_the_right_one():
    text = np.array([[0.0], [10.0], [20.0], [30.0]])
    motion = np.array([[4.0], [5.0], [19.0], [31.0]])
    motion[0], motion[1] = motion[1].copy(), [1.0]
    tops, _ = retrieval(text, motion)
    assert tops.tolist() == [0.5, 0.75, 1.0]


@settings(deadline=None)
@given(st.lists(st.sampled_from("abcdefghijkl"), min_size=1, max_size=80), st.integers(1, 6))
def test_pools_are_disjoint_full_and_without_equal_texts(texts, size):
    seen = set()
    for pool in pools(texts, np.random.default_rng(0), size):
        assert len({texts[i] for i in pool}) == size
        assert seen.isdisjoint(pool.tolist())
        seen.update(pool.tolist())


@settings(deadline=None)
@given(SETS, SETS)
def test_frechet_distance_is_symmetric_and_not_negative(a, b):
    there, back = frechet_distance(a, b), frechet_distance(b, a)
    scale = 1.0 + np.var(a) + np.var(b)
    assert there == pytest.approx(back, abs=1e-3 * scale)
    assert there > -1e-3 * scale
    assert frechet_distance(a, a) == pytest.approx(0.0, abs=1e-3 * scale)


def test_frechet_distance_of_shifted_and_scaled_gaussians_is_the_formula():
    rng = np.random.default_rng(0)
    x = rng.normal(size=(200_000, 2))
    assert frechet_distance(x, x + np.array([3.0, 4.0])) == pytest.approx(25.0, rel=1e-3)
    # equal means, standard deviations 1 and 3: d * (3 - 1)^2
    assert frechet_distance(x, 3.0 * x) == pytest.approx(8.0, rel=2e-2)


def test_diversity_never_pairs_a_motion_with_itself():
    rng = np.random.default_rng(0)
    assert diversity(np.array([[0.0], [1.0]]), rng) == 1.0
    assert multimodality([np.zeros((4, 2)), np.array([[0.0], [2.0]])], rng) == 1.0


def test_an_estimate_has_its_interval():
    estimate = Estimate.of([1.0, 2.0, 3.0])
    assert estimate.mean == 2.0
    assert estimate.interval == pytest.approx(1.96 / np.sqrt(3.0))
    assert Estimate.of([5.0]).interval == 0.0
