"""The humanoid is the canonical skeleton, both ways, and its file is what the code writes."""

import mujoco
import numpy as np
from hypothesis import given, settings
from synthetic import smooth_motions, standing

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.humanoid import humanoid_model, write_humanoid
from motiondiffuse_ros.physics.state import motion_to_qpos, qpos_to_motion, state_velocities
from motiondiffuse_ros.share import share_dir

BODIES = [humanoid_model().body(name).id for name in CANONICAL.names]


@settings(max_examples=30, deadline=None)
@given(smooth_motions())
def test_mujoco_puts_every_joint_where_the_motion_has_it(motion):
    data = mujoco.MjData(humanoid_model())
    qpos = motion_to_qpos(motion)
    for frame in range(0, motion.frames, 9):
        data.qpos[:] = qpos[frame]
        mujoco.mj_kinematics(humanoid_model(), data)
        assert np.abs(data.xpos[BODIES] - motion.positions[frame]).max() < 1e-6


@settings(max_examples=30, deadline=None)
@given(smooth_motions())
def test_positions_and_motions_are_inverse(motion):
    back = qpos_to_motion(motion_to_qpos(motion), motion.fps)
    assert rot.angle_between(back.rotations, motion.rotations).max() < 1e-6
    assert np.array_equal(back.root, motion.root)


def test_sixty_three_limited_hinges_and_seventy_kilograms():
    model = humanoid_model()
    names = [model.joint(j).name for j in range(1, model.njnt)]
    assert tuple(names) == hinge_table().names
    assert len(names) == 63
    assert model.jnt_limited[1:].all()
    assert abs(model.body_subtreemass[1] - 70.0) < 0.1


def test_left_and_right_ranges_are_mirrored():
    table = hinge_table()
    sign = {"x": -1.0, "y": 1.0, "z": -1.0}
    for k, name in enumerate(table.names):
        if name.startswith("left_"):
            other = table.names.index(name.replace("left_", "right_"))
            ends = sorted(sign[name[-1]] * np.array([table.lower[k], table.upper[k]]))
            assert np.allclose(ends, [table.lower[other], table.upper[other]])


def test_standing_touches_the_floor_with_both_soles_only():
    model, data = humanoid_model(), mujoco.MjData(humanoid_model())
    data.qpos[:] = motion_to_qpos(standing(1))[0]
    data.qpos[2] -= 0.001
    mujoco.mj_forward(model, data)
    touching = {model.geom(g).name for contact in data.contact for g in contact.geom}
    assert touching == {"floor", "left_ankle", "left_foot", "right_ankle", "right_foot"}


def test_velocities_integrate_to_the_next_position():
    from synthetic import waving

    motion = waving(40, fps=200.0)
    qpos = motion_to_qpos(motion)
    velocity, _ = state_velocities(qpos, motion.fps)
    model = humanoid_model()
    for frame in range(1, motion.frames - 1):
        expected = np.zeros(model.nv)
        mujoco.mj_differentiatePos(
            model, expected, 2 / motion.fps, qpos[frame - 1], qpos[frame + 1]
        )
        assert np.allclose(velocity[frame - 1], expected, atol=1e-6)


def test_the_shipped_model_files_are_what_the_code_writes(tmp_path):
    for path in write_humanoid(tmp_path):
        shipped = share_dir() / "sim" / path.name
        assert shipped.read_text() == path.read_text()
        assert mujoco.MjModel.from_xml_path(str(shipped)).nu == 63
