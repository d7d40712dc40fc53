"""A motion at the wrong height is put on the floor, and jumps stay jumps."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import moved, standing, waving

from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.physics import assess, put_on_floor
from motiondiffuse_ros.physics.ground_contact import ground_errors
from motiondiffuse_ros.physics.repair.ground import follow_floor

UP = np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize("height", [-0.07, 0.0, 0.12])
def test_a_constant_error_of_height_goes(height):
    wrong = moved(waving(40), height * UP)
    repaired = put_on_floor(wrong)
    assert np.allclose(repaired.root, waving(40).root)
    assert repaired.rotations is wrong.rotations
    assert assess(repaired, track=False).verdict == "plausible"


def test_a_jump_keeps_its_height():
    hop = np.zeros((40, 3))
    hop[15:25, 2] = 0.3
    assert np.allclose(put_on_floor(moved(standing(40), hop + 0.05 * UP)).root[20, 2], 0.96 + 0.3)


def test_who_climbs_on_air_comes_down_and_who_jumps_does_not():
    height = np.zeros((100, 3))
    height[10:20, 2] = 0.3
    height[40:, 2] = 0.4
    followed = follow_floor(moved(standing(100), height)).root[:, 2] - 0.96
    assert followed[15] > 0.29
    assert np.abs(followed[[0, 30, 60, 99]]).max() < 0.021


def test_a_body_that_lies_in_the_floor_is_brought_up():
    lying = standing(60)
    rotations = lying.rotations.copy()
    rotations[:, 0] = rot.about_axis(1, np.array([np.pi / 2.0]))
    sunk = moved(replace(lying, rotations=rotations), -0.96 * UP)
    assert ground_errors(sunk).penetrate.mean() > 50.0
    assert ground_errors(follow_floor(sunk)).penetrate.mean() < 21.0


def test_small_errors_of_height_are_not_for_the_root():
    wobble = 0.015 * np.sin(np.arange(60) / 5.0)[:, None] * UP
    wobbling = moved(standing(60), wobble)
    assert np.allclose(follow_floor(wobbling).root, wobbling.root)
