"""The simulated robot goes where the trajectory says, or says how far it is off."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import standing, waving

from motiondiffuse_ros.errors import MotionFileError, PhysicsError, RobotError
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.robots import build_trajectory, get_robot
from motiondiffuse_ros.robots.simulation import ExecutedMotion, SimulatedRobot, SimulationConfig

ROBOT = get_robot("humanoid")


def walked(metres: float, turn: float = 0.0):
    """A standing body slid along its facing direction and turned: enough to move the root."""
    still = standing(60)
    share = np.linspace(0.0, 1.0, 60)
    root = still.root + np.stack([metres * share, 0 * share, 0 * share], axis=1)
    rotations = still.rotations.copy()
    rotations[:, 0] = rot.about_axis(2, turn * share)
    return build_trajectory(ROBOT, replace(still, root=root, rotations=rotations))


def run(robot: SimulatedRobot, trajectory) -> ExecutedMotion:
    robot.follow(trajectory)
    while robot.state != "finished":
        robot.step()
    return robot.executed()


def test_it_stands_until_told_otherwise():
    robot = SimulatedRobot(ROBOT)
    height = robot.data.qpos[2]
    while robot.time < 1.0:
        robot.step()
    assert robot.state == "waiting"
    assert abs(robot.data.qpos[2] - height) < 0.03
    with pytest.raises(PhysicsError, match="nothing was followed"):
        robot.executed()


def test_assisted_it_follows_joints_and_root():
    trajectory = build_trajectory(ROBOT, waving(80))
    executed = run(SimulatedRobot(ROBOT), trajectory)
    assert abs(len(executed.qpos) / executed.fps - trajectory.duration) < 0.1
    assert executed.joint_error < 0.1
    assert executed.root_error < 0.05
    assert executed.assisted
    assert executed.assistance.max() > 0.0


def test_free_no_outside_force_acts():
    robot = SimulatedRobot(ROBOT, SimulationConfig(assisted=False))
    executed = run(robot, build_trajectory(ROBOT, waving(40)))
    assert not executed.assisted
    assert not executed.assistance.any()
    assert not robot.data.qfrc_applied.any()
    assert not robot.data.xfrc_applied.any()


def test_a_second_trajectory_starts_where_and_how_the_robot_stands():
    robot = SimulatedRobot(ROBOT)
    run(robot, walked(1.0, turn=np.pi / 2))
    executed = run(robot, walked(1.0))
    # one metre along x, then, having turned left, one metre along y
    assert np.allclose(executed.qpos[-1, :2], [1.0, 1.0], atol=0.15)


def test_joints_in_another_order_are_the_same_motion():
    trajectory = build_trajectory(ROBOT, waving(40))
    order = np.argsort(trajectory.joint_names)
    shuffled = replace(
        trajectory,
        joint_names=tuple(trajectory.joint_names[j] for j in order),
        positions=trajectory.positions[:, order],
        velocities=trajectory.velocities[:, order],
    )
    first = run(SimulatedRobot(ROBOT), trajectory)
    second = run(SimulatedRobot(ROBOT), shuffled)
    assert np.array_equal(first.qpos, second.qpos)


def test_joints_of_another_robot_are_refused():
    trajectory = build_trajectory(ROBOT, waving(40))
    names = ("left_wheel", *trajectory.joint_names[1:])
    with pytest.raises(RobotError, match="not those of 'humanoid'"):
        SimulatedRobot(ROBOT).follow(replace(trajectory, joint_names=names))


def test_the_shared_model_stays_as_it_is():
    before = ROBOT.model.dof_damping.copy()
    SimulatedRobot(ROBOT)
    assert np.array_equal(ROBOT.model.dof_damping, before)


def test_an_executed_motion_survives_its_file(tmp_path):
    executed = run(SimulatedRobot(ROBOT), build_trajectory(ROBOT, waving(20)))
    executed.save_npz(tmp_path / "a" / "executed.npz")
    back = ExecutedMotion.load_npz(tmp_path / "a" / "executed.npz")
    assert (back.robot, back.fps, back.assisted) == ("humanoid", executed.fps, True)
    assert np.array_equal(back.qpos, executed.qpos)
    assert [p.name for p in (tmp_path / "a").iterdir()] == ["executed.npz"]


def test_a_file_of_something_else_is_refused(tmp_path):
    path = tmp_path / "x.npz"
    path.write_bytes(b"not an archive")
    with pytest.raises(MotionFileError, match="not an executed motion"):
        ExecutedMotion.load_npz(path)


def test_a_real_robot_follows_with_its_own_actuators(g1):
    executed = run(SimulatedRobot(g1), build_trajectory(g1, waving(30)))
    assert executed.robot == "g1"
    assert executed.qpos.shape[1] == 7 + 29
    assert executed.joint_error < 0.05
    assert executed.root_error < 0.03
