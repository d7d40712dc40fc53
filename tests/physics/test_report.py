"""The verdict: plausible motions pass, broken ones do not, and the reason says what and when."""

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from synthetic import drifting, moved, smooth_motions, standing, waving

from motiondiffuse_ros.errors import Cancelled
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.physics import assess
from motiondiffuse_ros.physics.report import METRICS

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Segment:
    text: str
    start: float
    end: float
    parts: tuple[str, ...] = ()


def _jittered(motion):
    rng = np.random.default_rng(0)
    noise = rot.from_rotation_vector(0.05 * rng.normal(size=(*motion.rotations.shape[:2], 3)))
    return replace(motion, rotations=rot.multiply(motion.rotations, noise))


def test_a_wave_on_the_spot_is_plausible_without_reasons():
    report = assess(waving(60))
    assert report.verdict == "plausible"
    assert report.reasons == ()
    assert report.score > 0.95
    assert report.metrics["time_to_fall_s"] == pytest.approx(waving(60).duration)


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        (moved(waving(60), 0.05 * UP), "weight is carried by nothing at 0.0-3.0 s"),
        (moved(waving(60), -0.05 * UP), "goes 50 mm into the floor at 0.0-3.0 s"),
        (drifting(waving(60), 0.5), "foot slides 0.5 m/s at 0.0-3.0 s"),
        (_jittered(waving(60)), "jerks with"),
    ],
)
def test_a_broken_motion_is_implausible_and_the_reason_says_why(motion, words):
    report = assess(motion, track=False)
    assert report.verdict == "implausible"
    assert any(words in reason for reason in report.reasons), report.reasons
    assert report.score < 0.5


def test_the_reason_names_the_time_of_the_fault():
    sunk = np.zeros((100, 3))
    sunk[40:80, 2] = -0.1
    report = assess(moved(standing(100), sunk), track=False)
    assert any("into the floor at 2.0-4.0 s" in reason for reason in report.reasons)


def test_segments_are_judged_on_their_own():
    sunk = np.zeros((100, 3))
    sunk[50:, 2] = -0.1
    segments = (Segment("stands", 0.0, 2.0), Segment("sinks", 3.0, 4.9, ("legs",)))
    first, second = assess(moved(standing(100), sunk), segments=segments, track=False).segments
    assert (first.verdict, second.verdict) == ("plausible", "implausible")
    assert second.parts == ("legs",)
    assert any("at 3.0-5.0 s" in reason for reason in second.reasons)


def test_worse_is_scored_lower():
    scores = [
        assess(moved(waving(40), -d * UP), track=False).score for d in (0.0, 0.01, 0.02, 0.05)
    ]
    assert scores == sorted(scores, reverse=True)


def test_every_report_has_all_keys_and_is_json():
    for report in (assess(waving(40)), assess(waving(40), track=False), assess(waving(1))):
        assert set(METRICS) <= set(report.metrics)
        again = json.loads(json.dumps(report.to_dict(), allow_nan=False))
        assert again["verdict"] == report.verdict
    assert assess(waving(40), track=False).metrics["time_to_fall_s"] is None


@pytest.mark.parametrize("frames", [1, 2, 3, 4])
def test_a_motion_too_short_for_dynamics_is_implausible(frames):
    report = assess(standing(frames))
    assert report.verdict == "implausible"
    assert "dynamics need 0.20 s or more" in report.reasons[0]
    assert report.score == 0.0


def test_a_motion_with_nan_is_implausible():
    broken = waving(40)
    broken.rotations[7, 3, 0] = np.nan
    report = assess(broken)
    assert report.verdict == "implausible"
    assert "not finite" in report.reasons[0]


def test_it_can_be_cancelled():
    with pytest.raises(Cancelled):
        assess(waving(40), cancelled=lambda: True)


def test_progress_ends_at_one():
    shares: list[float] = []
    assess(waving(40), progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)


@settings(max_examples=25, deadline=None)
@given(smooth_motions(max_amplitude=3.0))
def test_any_motion_gets_a_verdict(motion):
    report = assess(motion, track=False)
    assert report.verdict in ("plausible", "marginal", "implausible")
    assert 0.0 <= report.score <= 1.0
    assert (report.verdict == "plausible") == (report.reasons == ())
    json.dumps(report.to_dict(), allow_nan=False)
