"""The same report on any floating-base MJCF; broken ones are refused in words."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from synthetic import moved, standing, turned, waving

from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.physics import assess
from motiondiffuse_ros.physics.any_robot import assess_states
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.humanoid import humanoid_model
from motiondiffuse_ros.physics.mjcf_states import load_mjcf, resample_states
from motiondiffuse_ros.physics.state import motion_to_qpos

UP = np.array([0.0, 0.0, 1.0])

BIPED = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="base" pos="0 0 0.65">
      <freejoint/>
      <geom type="box" size="0.1 0.12 0.15" mass="8"/>
      <body name="left_leg" pos="0 0.1 -0.2">
        <joint name="left_hip" axis="0 1 0" range="-60 60" actuatorfrcrange="-80 80"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.38" size="0.03" mass="2"/>
        <body name="left_sole" pos="0 0 -0.4">
          <geom type="box" size="0.1 0.04 0.02" pos="0.02 0 -0.03" mass="0.5"/>
        </body>
      </body>
      <body name="right_leg" pos="0 -0.1 -0.2">
        <joint name="right_hip" axis="0 1 0" range="-60 60" actuatorfrcrange="-80 80"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.38" size="0.03" mass="2"/>
        <body name="right_sole" pos="0 0 -0.4">
          <geom type="cylinder" size="0.06 0.02" pos="0.02 0 -0.03" mass="0.5"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
FEET = ("left_sole", "right_sole")


@pytest.fixture(scope="module")
def biped() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(BIPED)


def _still(model: mujoco.MjModel, frames: int = 60) -> np.ndarray:
    return np.tile(model.qpos0, (frames, 1))


def test_a_robot_that_stands_is_plausible(biped):
    report = assess_states(biped, _still(biped), 50.0, feet=FEET)
    assert report.verdict == "plausible", report.reasons
    assert report.metrics["root_residual_force_bw"] == pytest.approx(0.0, abs=0.02)
    assert report.metrics["time_to_fall_s"] is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda q, t: q[:, 2].__iadd__(0.1), "weight is carried by nothing"),
        (lambda q, t: q[:, 2].__isub__(0.05), "sole goes 50 mm into the floor"),
        (lambda q, t: q[:, 0].__iadd__(0.5 * t), "sole slides 0.5 m/s"),
        (lambda q, t: q[:, 7].__iadd__(1.3), "left hip is"),
        (lambda q, t: q[:, 2].__iadd__(0.02 * (-1.0) ** np.arange(len(q))), "jerks with"),
    ],
)
def test_what_is_wrong_is_named(biped, change, words):
    qpos = _still(biped, 60)
    change(qpos, np.arange(60) / 20.0)
    report = assess_states(biped, qpos, 20.0, feet=FEET)
    assert report.verdict == "implausible"
    assert any(words in reason for reason in report.reasons), report.reasons


def test_the_humanoid_gets_the_figures_of_its_own_report():
    motion = moved(waving(40), 0.01 * UP)
    own = assess(motion, track=False).metrics
    feet = ("left_ankle", "right_ankle")
    limits = hinge_table().velocity_limits
    other = assess_states(
        humanoid_model(), motion_to_qpos(motion), 20.0, feet=feet, velocity_limits=limits
    ).metrics
    for name in ("penetrate_mm", "root_residual_force_bw", "torque_violation", "peak_power_w"):
        assert other[name] == pytest.approx(own[name], abs=1e-6), name


def test_parts_inside_each_other_are_found(biped):
    qpos = _still(biped, 20)
    assert assess_states(biped, qpos, 20.0, feet=FEET).metrics["self_collision"] == 0.0
    crossed = standing(20)
    rotations = crossed.rotations.copy()
    turned(rotations, "left_hip", 0, -0.35)
    turned(rotations, "right_hip", 0, 0.35)
    legs = assess(replace(crossed, rotations=rotations), track=False)
    assert legs.metrics["self_collision"] == 1.0


def test_states_that_are_broken_are_implausible_or_refused(biped):
    qpos = _still(biped, 30)
    assert "dynamics need" in assess_states(biped, qpos[:1], 20.0, feet=FEET).reasons[0]
    broken = qpos.copy()
    broken[4, 8] = np.nan
    assert "not finite" in assess_states(biped, broken, 20.0, feet=FEET).reasons[0]
    with pytest.raises(InputError, match=r"qpos must be \[frames, 9\]"):
        assess_states(biped, qpos[:, :8], 20.0, feet=FEET)
    with pytest.raises(InputError, match="no body 'paw'"):
        assess_states(biped, qpos, 20.0, feet=("paw",))
    with pytest.raises(InputError, match="fps must be positive"):
        assess_states(biped, qpos, 0.0, feet=FEET)


def test_models_that_are_broken_are_refused(tmp_path):
    path = tmp_path / "robot.xml"
    path.write_text("<mujoco><worldbody><body><joint/></body></worldbody>", encoding="utf-8")
    with pytest.raises(InputError, match="not a usable MJCF"):
        load_mjcf(path)
    with pytest.raises(InputError, match="not a usable MJCF"):
        load_mjcf(tmp_path / "nowhere.xml")
    fixed = mujoco.MjModel.from_xml_string(BIPED.replace("<freejoint/>", "<joint/>"))
    with pytest.raises(InputError, match="free joint"):
        assess_states(fixed, np.zeros((10, fixed.nq)), 20.0, feet=FEET)


def test_states_at_another_rate_are_the_same_motion():
    qpos = motion_to_qpos(waving(41))
    there = resample_states(resample_states(qpos, 20.0, 60.0), 60.0, 20.0)
    assert np.allclose(there, qpos, atol=1e-9)
