"""Any rotation splits into three hinges and comes back, in every order of axes."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.physics.hinges import (
    continuous_hinge_angles,
    hinge_angles,
    hinge_rotations,
)

ORDERS = ["".join(order) for order in permutations("xyz")]


@given(st.sampled_from(ORDERS), st.lists(st.floats(-1, 1), min_size=4, max_size=4))
def test_angles_chain_back_to_the_rotation(order, numbers):
    q = np.array(numbers)
    if np.linalg.norm(q) < 1e-3:
        return
    q = rot.normalise(q)
    back = hinge_rotations(hinge_angles(q, order), order)
    assert rot.angle_between(back, q) < 1e-6


@pytest.mark.parametrize("order", ORDERS)
def test_a_full_turn_of_the_first_hinge_does_not_jump(order):
    angles = np.zeros((100, 3))
    angles[:, 0] = np.linspace(0.0, 2 * np.pi, 100)
    angles[:, 1] = 0.4
    found = continuous_hinge_angles(hinge_rotations(angles, order), order, np.zeros(3))
    assert np.abs(np.diff(found, axis=0)).max() < 0.1
    assert (
        rot.angle_between(hinge_rotations(found, order), hinge_rotations(angles, order)).max()
        < 1e-6
    )


def test_a_middle_hinge_beyond_ninety_degrees_is_followed():
    angles = np.zeros((80, 3))
    angles[:, 1] = np.linspace(0.0, 2.2, 80)
    angles[:, 0] = 0.3
    found = continuous_hinge_angles(hinge_rotations(angles, "yxz"), "yxz", np.zeros(3))
    assert np.allclose(found, angles, atol=1e-6)
