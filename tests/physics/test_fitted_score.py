"""The shipped score: prefers real motion, and says which statistic speaks against another."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import logit
from synthetic import drifting, moved, waving

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.body_states import humanoid_states
from motiondiffuse_ros.physics.dynamics import state_dynamics
from motiondiffuse_ros.physics.fitted_score import FittedScore, fitted_score
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.statistics import statistics

UP = np.array([0.0, 0.0, 1.0])


def _statistics(motion: Motion) -> dict[str, float]:
    states = humanoid_states(motion, hinge_table())
    return statistics(motion, states, state_dynamics(states))


@pytest.mark.parametrize(
    ("broken", "words"),
    [
        (moved(waving(60), 0.05 * UP), ("point", "height", "unsupported", "residual")),
        (moved(waving(60), -0.05 * UP), ("point", "height")),
        (drifting(waving(60), 0.4), ("foot", "skating", "travel", "speed")),
    ],
)
def test_broken_motion_scores_low_and_the_statistic_is_named(broken, words):
    model = fitted_score()
    values = _statistics(broken)
    assert model.score(values) < model.marginal_below < model.score(_statistics(waving(60)))
    told = model.worst(values, 3)
    assert any(word in line for word in words for line in told), told


def test_a_part_is_what_the_usual_value_would_change():
    model, values = fitted_score(), _statistics(waving(60))
    parts = model.parts(values)
    for n in (0, int(parts.argmin()), int(parts.argmax())):
        usual = {**values, model.names[n]: model.centre[n]}
        change = logit(model.score(values)) - logit(model.score(usual))
        assert parts[n] == pytest.approx(change, abs=1e-6)


def test_far_off_values_do_not_overflow():
    model = fitted_score()
    values = dict.fromkeys(model.names, 1e12)
    assert 0.0 <= model.score(values) <= 1.0


def test_json_and_back_is_the_same():
    model = fitted_score()
    again = FittedScore.from_dict(json.loads(json.dumps(model.to_dict())))
    values = _statistics(waving(40))
    assert again.score(values) == pytest.approx(model.score(values), rel=1e-3)
    assert replace(again).names == model.names


@pytest.mark.parametrize("frames", [5, 6, 9])
def test_the_shortest_motions_have_all_statistics(frames):
    assert all(np.isfinite(v) for v in _statistics(waving(frames)).values())
