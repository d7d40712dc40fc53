"""Every trajectory keeps its promises, whatever the motion."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic import smooth_motions, standing, turned, waving

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.robots import (
    broken_promises,
    build_trajectory,
    get_robot,
    to_joint_positions,
)

ROBOT = get_robot("humanoid")


@settings(max_examples=60, deadline=None)
@given(smooth_motions(max_amplitude=2.5), st.sampled_from([20.0, 50.0, 100.0]))
def test_limits_times_and_rest_hold_for_any_motion(motion, rate):
    assert broken_promises(build_trajectory(ROBOT, motion, rate), ROBOT) == ()


def test_it_starts_at_the_first_pose_and_follows_the_motion():
    motion = waving(60)
    trajectory = build_trajectory(ROBOT, motion)
    joints = to_joint_positions(ROBOT, motion)
    assert np.allclose(trajectory.positions[0], joints[0], atol=1e-9)
    # 50 Hz and 20 Hz meet every tenth of a second; the last half second is the slow-down
    for frame in range(0, motion.frames - 11, 2):
        point = round(frame / motion.fps * 50)
        assert np.allclose(trajectory.positions[point], joints[frame], atol=1e-6)
    assert trajectory.notes == ()


def test_it_lasts_as_long_as_the_motion_and_stops_on_the_path():
    motion = waving(61)
    trajectory = build_trajectory(ROBOT, motion)
    assert trajectory.duration == pytest.approx(motion.duration)
    end = to_joint_positions(ROBOT, motion.resample(100.0))
    a_quarter_before = round((motion.duration - 0.25) * 100)
    assert np.allclose(trajectory.positions[-1], end[a_quarter_before], atol=1e-4)


def test_speed_falls_smoothly_to_zero():
    trajectory = build_trajectory(ROBOT, waving(80))
    speed = np.linalg.norm(trajectory.velocities, axis=1)
    assert speed[-1] == 0.0
    assert speed[-2] < 0.02 * speed.max()
    assert np.abs(np.diff(trajectory.velocities, axis=0)).max() < 0.12 * speed.max()


def test_a_joint_beyond_its_range_is_held_and_named():
    still = standing(60)
    rotations = still.rotations.copy()
    turned(rotations, "left_knee", 1, np.linspace(0.0, -1.0, 60))
    trajectory = build_trajectory(ROBOT, replace(still, rotations=rotations))
    assert broken_promises(trajectory, ROBOT) == ()
    assert any(note.startswith("left_knee_y held at its limit") for note in trajectory.notes)


def test_a_joint_that_is_too_fast_slows_the_body_for_a_moment():
    still = standing(100)
    rotations = still.rotations.copy()
    swing = 1.5 * np.tanh((np.arange(100) - 50) / 0.9)
    turned(rotations, "left_hip", 1, swing - 0.9)
    # it ends on one leg
    trajectory = build_trajectory(ROBOT, replace(still, rotations=rotations), settle=False)
    assert broken_promises(trajectory, ROBOT) == ()
    assert any("left_hip_y would turn at" in note for note in trajectory.notes)
    assert still.duration < trajectory.duration < still.duration + 0.5


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan"), float("inf")])
def test_a_rate_that_is_none_is_refused(rate):
    with pytest.raises(RobotError, match="positive rate"):
        build_trajectory(ROBOT, standing(5), rate)


def test_a_motion_with_nan_is_refused():
    still = standing(5)
    root = still.root.copy()
    root[2, 1] = np.nan
    with pytest.raises(RobotError, match="not finite"):
        build_trajectory(ROBOT, replace(still, root=root))


def test_files_hold_every_point(tmp_path):
    trajectory = build_trajectory(ROBOT, waving(30))
    trajectory.save_csv(tmp_path / "trajectory.csv")
    trajectory.save_root_csv(tmp_path / "root.csv")
    table = np.genfromtxt(tmp_path / "trajectory.csv", delimiter=",", names=True)
    assert len(table) == len(trajectory.times)
    assert len(table.dtype.names or ()) == 1 + 2 * 63
    assert np.allclose(
        table["right_elbow_z_position"], trajectory.positions[:, _column("right_elbow_z")]
    )
    assert np.allclose(
        table["right_elbow_z_velocity"], trajectory.velocities[:, _column("right_elbow_z")]
    )
    root = np.genfromtxt(tmp_path / "root.csv", delimiter=",", names=True)
    assert root.dtype.names == ("time", "x", "y", "z", "qw", "qx", "qy", "qz")
    assert np.allclose(root["z"], trajectory.root_position[:, 2])


def _column(name: str) -> int:
    return ROBOT.joint_names.index(name)
