"""The validator sees each promise that is broken."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import waving

from motiondiffuse_ros.robots import broken_promises, build_trajectory, get_robot

ROBOT = get_robot("humanoid")
GOOD = build_trajectory(ROBOT, waving(40))


def _changed(name, index, value):
    array = getattr(GOOD, name).copy()
    array[index] = value
    return replace(GOOD, **{name: array})


@pytest.mark.parametrize(
    ("trajectory", "words"),
    [
        (replace(GOOD, joint_names=GOOD.joint_names[::-1]), "joint names"),
        (replace(GOOD, positions=GOOD.positions[:-1]), "shape"),
        (replace(GOOD, accelerations=GOOD.positions[:-1]), "shape"),
        (_changed("positions", (3, 4), np.nan), "not finite"),
        (_changed("times", 0, 0.01), "strictly"),
        (_changed("times", 5, GOOD.times[4]), "strictly"),
        (_changed("velocities", (-1, 0), 1e-6), "last point of velocities"),
        (_changed("root_linear_velocity", (-1, 0), 1e-6), "last point of root_linear"),
        (_changed("root_orientation", 3, 0.0), "unit length"),
        (_changed("positions", (3, 4), 4.0), "position limit"),
        (_changed("velocities", (3, 4), 99.0), "velocity limit"),
        (_changed("velocities", 3, 0.2), "differ from the positions"),
    ],
)
def test_a_broken_promise_is_named(trajectory, words):
    assert any(words in line for line in broken_promises(trajectory, ROBOT))
