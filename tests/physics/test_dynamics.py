"""Inverse dynamics tells standing, falling, hovering, leaning and pushing off apart."""

import numpy as np
import pytest
from synthetic import moved, standing, turned

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.dynamics import inverse_dynamics

UP = np.array([0.0, 0.0, 1.0])


def test_the_floor_can_carry_a_body_that_stands():
    found = inverse_dynamics(standing(10))
    assert found.supported.all()
    assert found.residual_force.max() < 0.01
    assert found.residual_torque.max() < 0.01
    # hanging limbs and a straight back need little
    assert np.abs(found.torques).max() < 40.0


def test_a_hovering_body_misses_its_whole_weight():
    found = inverse_dynamics(moved(standing(10), 0.2 * UP))
    assert not found.supported.any()
    assert np.allclose(found.residual_force, 1.0, atol=1e-6)


def test_a_ballistic_flight_misses_nothing():
    times = np.arange(16)[:, None] / 20.0
    flying = moved(standing(16), (0.3 + 3.7 * times - 0.5 * 9.81 * times**2) * UP)
    found = inverse_dynamics(flying)
    assert not found.supported.any()
    assert found.residual_force.max() < 1e-6
    assert found.residual_torque.max() < 1e-6


@pytest.mark.parametrize(("degrees", "balanced"), [(3.0, True), (25.0, False)])
def test_a_lean_beyond_the_feet_is_out_of_balance(degrees, balanced):
    still = standing(10)
    rotations = still.rotations.copy()
    turned(rotations, "pelvis", 1, np.radians(degrees))
    leaning = Motion(still.root, rotations, still.fps)
    lowest = leaning.positions[..., 2].min()
    found = inverse_dynamics(moved(leaning, -(lowest - 0.02) * UP))
    assert (found.residual_torque.max() < 0.02) == balanced


@pytest.mark.parametrize(("acceleration", "possible"), [(1.0, True), (20.0, False)])
def test_friction_bounds_how_fast_a_body_can_start(acceleration, possible):
    times = np.arange(10)[:, None] / 20.0
    starting = moved(standing(10), 0.5 * acceleration * times**2 * np.array([1.0, 0.0, 0.0]))
    found = inverse_dynamics(starting)
    assert (found.residual_force.max() < 0.1) == possible


def test_a_loaded_knee_needs_torque():
    still = standing(10)
    rotations = still.rotations.copy()
    for side in ("left", "right"):
        turned(rotations, f"{side}_hip", 1, -1.0)
        turned(rotations, f"{side}_knee", 1, 1.6)
        turned(rotations, f"{side}_ankle", 1, -0.6)
    squat = Motion(still.root, rotations, still.fps)
    feet = squat.joint("left_foot")[0, 2]
    found = inverse_dynamics(moved(squat, -(feet - 0.02) * UP))
    from motiondiffuse_ros.physics.hinge_table import hinge_table

    knee = hinge_table().names.index("left_knee_y")
    assert np.abs(found.torques[:, knee]).min() > 40.0
