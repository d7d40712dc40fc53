"""Of several candidates the one that repair leaves most plausible is taken."""

import numpy as np
import pytest
from synthetic import drifting, standing, waving

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.repair import repair, repair_best
from motiondiffuse_ros.physics.report import PLAUSIBLE, assess

SEEDED = np.random.default_rng(5)


def shaking(metres: float = 0.05) -> Motion:
    """Stand while the root jumps about, beyond any repair."""
    still = standing()
    return still.with_root(still.root + metres * SEEDED.standard_normal(still.root.shape))


def test_among_broken_ones_it_finds_the_one_that_can_be_repaired():
    candidates = {3: shaking(), 5: drifting(waving(60), 0.15), 8: shaking()}
    assert assess(candidates[5], track=False).verdict != PLAUSIBLE
    best, repaired = repair_best(candidates)
    assert best == 5
    assert repaired.after.verdict == PLAUSIBLE


def test_where_none_becomes_plausible_the_best_score_wins():
    candidates = dict(enumerate([shaking(0.2), shaking(0.1)]))
    best, repaired = repair_best(candidates)
    scores = [repair(motion).after.score for motion in candidates.values()]
    assert repaired.after.verdict != PLAUSIBLE
    assert repaired.after.score == pytest.approx(scores[best])
    assert scores[best] == max(scores)


def test_the_first_plausible_one_is_taken_and_those_after_it_are_not_judged():
    judged: list[Motion] = []

    def judge(motion: Motion):
        judged.append(motion)
        return assess(motion, track=False)

    best, repaired = repair_best({4: waving(60), 1: waving(80), 2: shaking()}, judge)
    assert (best, len(judged)) == (4, 2)
    assert repaired.before.verdict == repaired.after.verdict == PLAUSIBLE
