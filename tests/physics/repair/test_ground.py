"""A motion at the wrong height is put on the floor, and nothing else changes."""

import numpy as np
import pytest
from synthetic import moved, standing, waving

from motiondiffuse_ros.physics import assess, put_on_floor

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
