"""A trajectory begins exactly in the state that the robot is in, however far off that is."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic import drifting, smooth_motions, waving

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.robots import (
    RootState,
    StartState,
    broken_promises,
    build_trajectory,
    get_robot,
)
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState

ROBOT = get_robot("humanoid")


@st.composite
def states(draw):
    """Any joints within their limits, some at them, some moving; a root nearby or unknown."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    share = rng.uniform(0.0, 1.0, len(ROBOT.joint_names)) ** draw(st.sampled_from([0.2, 1.0, 5.0]))
    positions = ROBOT.lower + share * (ROBOT.upper - ROBOT.lower)
    speeds = draw(st.floats(0.0, 0.3)) * rng.uniform(-1.0, 1.0, len(share)) * ROBOT.velocity_limits
    if draw(st.booleans()):
        return StartState(positions, speeds)
    turn = rng.normal(size=4)
    root = RootState(
        rng.normal(size=3), turn / np.linalg.norm(turn), rng.normal(size=3), rng.normal(size=3)
    )
    return StartState(positions, speeds, root)


@settings(max_examples=30, deadline=None)
@given(smooth_motions(max_amplitude=1.0), states(), st.sampled_from([20.0, 50.0, 100.0]))
def test_it_begins_in_any_state_and_keeps_its_promises(motion, state, rate):
    trajectory = build_trajectory(ROBOT, motion, rate, state)
    assert broken_promises(trajectory, ROBOT) == ()
    assert trajectory.duration < build_trajectory(ROBOT, motion, rate).duration + 12.0
    np.testing.assert_array_equal(trajectory.positions[0], state.positions)
    np.testing.assert_array_equal(trajectory.velocities[0], state.velocities)
    if state.root is not None:
        np.testing.assert_allclose(trajectory.root_position[0], state.root.position, atol=1e-9)
        same = abs(trajectory.root_orientation[0] @ state.root.orientation)
        assert same == pytest.approx(1.0, abs=1e-9)
        velocity = trajectory.root_linear_velocity[0]
        np.testing.assert_array_equal(velocity, state.root.linear_velocity)


def test_a_small_gap_closes_on_the_way():
    motion = waving(80)
    plain = build_trajectory(ROBOT, motion)
    state = StartState(plain.positions[0] + 0.1, plain.velocities[0] - 0.2)
    joined = build_trajectory(ROBOT, motion, start=state)
    assert joined.duration == plain.duration
    assert joined.notes == plain.notes
    late = plain.times > 0.55
    np.testing.assert_allclose(joined.positions[late], plain.positions[late], atol=2e-3)
    # no faster than it has to be: 0.1 rad in half a second, on top of the wave's own speed
    assert np.abs(joined.velocities - plain.velocities).max() < 0.6
    acceleration = np.diff(joined.velocities - plain.velocities, axis=0) * 50
    assert np.abs(acceleration).max() < 6.0


def test_a_wide_gap_is_closed_before_the_motion_and_noted():
    motion = waving(60)
    plain = build_trajectory(ROBOT, motion)
    state = StartState(ROBOT.rest_positions, 0.0 * ROBOT.rest_positions)
    joined = build_trajectory(ROBOT, motion, start=state)
    assert joined.duration > plain.duration + 0.5
    assert any("starts with an approach of" in note for note in joined.notes)
    np.testing.assert_allclose(joined.positions[-1], plain.positions[-1], atol=0.02)


def test_where_a_plan_has_got_to_is_where_the_same_plan_goes_on():
    motion = drifting(waving(80), 0.5)
    trajectory = build_trajectory(ROBOT, motion)
    running = TrajectoryState(trajectory)
    rest = motion.slice(30, 80)
    joined = build_trajectory(ROBOT, rest, start=running.at(1.5))
    np.testing.assert_allclose(joined.positions[:90], trajectory.positions[75:165], atol=0.01)
    np.testing.assert_allclose(
        joined.root_position[:90], trajectory.root_position[75:165], atol=0.01
    )


def test_the_body_is_read_back_from_a_trajectory():
    motion = drifting(waving(60), 0.5)
    running = TrajectoryState(build_trajectory(ROBOT, motion))
    back = running.motion_up_to(ROBOT, 2.0, 1.0, 20.0)
    assert back.frames == 21
    np.testing.assert_allclose(back.positions, motion.slice(20, 41).positions, atol=2e-3)
    assert running.motion_up_to(ROBOT, 0.3, 1.0, 20.0).frames == 7
    held = running.motion_up_to(ROBOT, running.trajectory.duration + 2.0, 1.0, 20.0)
    np.testing.assert_allclose(held.positions[0], held.positions[-1], atol=1e-9)


@pytest.mark.parametrize(
    ("positions", "says"),
    [(np.zeros(3), "63 joint positions"), (np.full(63, np.nan), "not finite")],
)
def test_a_state_that_is_none_is_refused(positions, says):
    with pytest.raises(RobotError, match=says):
        build_trajectory(ROBOT, waving(30), start=StartState(positions, np.zeros_like(positions)))
