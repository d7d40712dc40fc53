"""Files for trackers hold what their readers expect: order, conventions, velocities."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import drifting, standing, turned

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.robots import build_trajectory
from motiondiffuse_ros.robots.tracking_files import (
    foot_contacts,
    save_tracking_csv,
    save_tracking_npz,
)


@pytest.fixture(scope="module")
def trajectory(g1):
    motion = drifting(standing(60), 0.2)
    rotations = motion.rotations.copy()
    rotations[:, 0] = rot.about_axis(2, np.linspace(0.0, 1.0, 60))
    turned(rotations, "right_shoulder", 0, -np.linspace(0.0, 2.0, 60))
    return build_trajectory(g1, replace(motion, rotations=rotations))


def test_csv_rows_are_base_xyzw_and_joints(g1, trajectory, tmp_path):
    save_tracking_csv(trajectory, tmp_path / "tracking.csv")
    rows = np.loadtxt(tmp_path / "tracking.csv", delimiter=",")
    assert rows.shape == (len(trajectory.times), 7 + 29)
    assert np.allclose(rows[:, :3], trajectory.root_position, atol=1e-6)
    assert np.allclose(rows[:, 6], trajectory.root_orientation[:, 0], atol=1e-6)
    assert np.allclose(rows[:, 7:], trajectory.positions, atol=1e-6)


def test_npz_has_what_mjlab_reads_and_its_velocities_are_those_of_its_positions(
    g1, trajectory, tmp_path
):
    save_tracking_npz(trajectory, g1, tmp_path / "tracking.npz")
    with np.load(tmp_path / "tracking.npz", allow_pickle=False) as data:
        found = dict(data)
    points, bodies = len(trajectory.times), 30
    assert found["fps"].tolist() == [50]
    assert found["joint_pos"].shape == found["joint_vel"].shape == (points, 29)
    assert found["body_pos_w"].shape == found["body_lin_vel_w"].shape == (points, bodies, 3)
    assert found["body_quat_w"].shape == (points, bodies, 4)
    assert found["body_ang_vel_w"].shape == (points, bodies, 3)
    assert found["body_names"][0] == "pelvis"
    assert tuple(found["joint_names"]) == g1.joint_names
    assert np.allclose(found["body_pos_w"][:, 0], trajectory.root_position, atol=1e-5)
    moved = (found["body_pos_w"][2:] - found["body_pos_w"][:-2]) * 25.0
    assert np.abs(moved - found["body_lin_vel_w"][1:-1]).max() < 0.02
    spun = rot.to_rotation_vector(
        rot.multiply(found["body_quat_w"][2:], rot.conjugate(found["body_quat_w"][:-2]))
    )
    assert np.abs(25.0 * spun - found["body_ang_vel_w"][1:-1]).max() < 0.05
    assert found["foot_contacts"].shape == (points, 2)


def test_feet_that_stand_are_in_contact_and_feet_in_the_air_are_not(g1):
    still = build_trajectory(g1, standing(30))
    assert foot_contacts(still, g1).all()
    up = replace(still, root_position=still.root_position + np.array([0.0, 0.0, 0.1]))
    assert not foot_contacts(up, g1).any()


def test_the_joints_have_to_be_the_robots(booster_t1, trajectory, tmp_path):
    with pytest.raises(RobotError, match="are not those of"):
        save_tracking_npz(trajectory, booster_t1, tmp_path / "tracking.npz")
