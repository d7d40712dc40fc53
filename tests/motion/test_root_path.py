import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic import drifting, smooth_motions, standing

from motiondiffuse_ros.corpus.importer import load_motion
from motiondiffuse_ros.motion.features import PoseState
from motiondiffuse_ros.motion.root_path import PathPoint, RootPath

STATE = PoseState()
COORDINATE = st.floats(-3.0, 3.0)


def _bent(motion, points):
    features = torch.from_numpy(STATE.encode(motion)).float()[None]
    return RootPath(points, motion.frames, motion.fps)(features)[0].double().numpy()


@st.composite
def motions_and_points(draw):
    motion = draw(smooth_motions(max_amplitude=0.3).filter(lambda m: m.frames >= 5))
    frames = draw(st.sets(st.integers(1, motion.frames - 1), min_size=1, max_size=4))
    heading = st.one_of(st.none(), st.floats(-6.0, 6.0))
    points = [
        PathPoint(f, draw(COORDINATE), draw(COORDINATE), draw(heading)) for f in sorted(frames)
    ]
    return motion, points


@settings(deadline=None, max_examples=50)
@given(motions_and_points())
def test_the_decoded_root_meets_every_point(case):
    motion, points = case
    decoded = STATE.decode(_bent(motion, points), motion.fps)
    for point in points:
        np.testing.assert_allclose(
            decoded.root[point.frame, :2], [point.x, point.y], atol=2e-3 * motion.frames
        )
        if point.heading is not None:
            off = decoded.heading[point.frame] - point.heading
            assert abs(np.angle(np.exp(1j * off))) < 1e-3


def test_a_path_that_meets_its_points_stays_as_it_is(real_paths):
    motion = load_motion(real_paths[0]).canonicalised()
    last = motion.frames - 1
    points = [
        PathPoint(f, *motion.root[f, :2], heading=motion.heading[f]) for f in (last // 2, last)
    ]
    np.testing.assert_allclose(_bent(motion, points), STATE.encode(motion), atol=2e-3)


def test_all_joints_move_with_the_root():
    motion = drifting(standing(61), 1.0)  # 3 m ahead in 3 s, facing ahead
    bent = _bent(motion, [PathPoint(60, 3.0, 0.0, np.pi / 2)])
    decoded = STATE.decode(bent, motion.fps)
    again = STATE.encode(decoded)
    velocities = STATE.groups()["velocities"]
    # what the bent features say of every joint's velocity is what decoding them gives
    np.testing.assert_allclose(bent[:-1, velocities], again[:-1, velocities], atol=0.03)
    assert decoded.heading[-1] == pytest.approx(np.pi / 2, abs=1e-3)


def test_a_nearer_turn_is_preferred():
    motion = standing(41)
    decoded = STATE.decode(_bent(motion, [PathPoint(40, 0.0, 0.0, 1.5 * np.pi)]), motion.fps)
    assert decoded.heading[-1] == pytest.approx(-np.pi / 2, abs=1e-3)
