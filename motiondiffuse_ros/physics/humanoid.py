"""The canonical skeleton as a MuJoCo body: a free root, 21 joints of three hinges each, 70 kg."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import mujoco
import numpy as np

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import STANDING_HEIGHT
from motiondiffuse_ros.physics.geometry import SOLIDS, Solid
from motiondiffuse_ros.physics.hinge_table import HingeTable, hinge_table
from motiondiffuse_ros.physics.hinges import AXES

DAMPING_RATIO = 0.06
"""PD velocity gain over position gain [s]."""

TIMESTEP = 0.0025
"""Of the simulation [s]."""

_LEFT, _RIGHT, _TRUNK = (0.16, 0.47, 0.84, 1.0), (0.92, 0.41, 0.20, 1.0), (0.32, 0.35, 0.41, 1.0)
_ARMS_DOWN = 1.3


def build_humanoid(*, scene: bool = False) -> mujoco.MjSpec:
    """Describe the humanoid.

    Hinges are named `left_hip_y` and so on, bodies as the canonical joints, position actuators
    (PD with torque limits) as the hinges.

    Args:
        scene: Add floor, light and sky, so that the model can be simulated and looked at.
    """
    spec = _bodies(scene)
    for a, b in _overlaps_at_rest():
        spec.add_exclude(bodyname1=a, bodyname2=b)
    return spec


@cache
def humanoid_model() -> mujoco.MjModel:
    """Return the compiled humanoid on its floor. Shared: do not change it."""
    return build_humanoid(scene=True).compile()


def rest_angles() -> Array:
    """Return the hinges of an upright stance with hanging arms [63], rad."""
    return _arms_lowered(_ARMS_DOWN)


def write_humanoid(folder: Path) -> tuple[Path, Path]:
    """Write `humanoid.xml` and `humanoid_scene.xml` (with floor), for people and other programs.

    Returns:
        The two paths.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = (folder / "humanoid.xml", folder / "humanoid_scene.xml")
    for path, scene in zip(paths, (False, True), strict=True):
        spec = build_humanoid(scene=scene)
        spec.compile()
        path.write_text(spec.to_xml(), encoding="utf-8")
    return paths


def _bodies(scene: bool) -> mujoco.MjSpec:
    spec = mujoco.MjSpec()
    spec.modelname = "humanoid"
    spec.compiler.autolimits = True
    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    if scene:
        add_scene(spec)
    table = hinge_table()
    for j, name in enumerate(CANONICAL.names):
        parent = CANONICAL.parents[j]
        if parent < 0:
            body = spec.worldbody.add_body(name=name, pos=[0.0, 0.0, STANDING_HEIGHT])
            body.add_freejoint(name="root")
        else:
            body = spec.body(CANONICAL.names[parent]).add_body(name=name, pos=CANONICAL.offsets[j])
            _add_hinges(body, table, table.joints.index(j))
        for solid in (solid for solid in SOLIDS if solid.joint == name):
            _add_geom(body, solid)
    _add_actuators(spec, table)
    return spec


def _add_hinges(body: mujoco.MjsBody, table: HingeTable, joint: int) -> None:
    tilt = rot.about_axis(0, table.tilts[joint])
    body.quat = tilt
    for n, axis in enumerate(table.orders[joint]):
        k = 3 * joint + n
        # hinge axes live in the tilted body's frame
        direction = rot.rotate(rot.conjugate(tilt), np.eye(3)[AXES.index(axis)])
        body.add_joint(
            name=table.names[k],
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=direction,
            range=np.degrees([table.lower[k], table.upper[k]]),
            armature=table.armature[k],
        )


def _add_actuators(spec: mujoco.MjSpec, table: HingeTable) -> None:
    """One PD actuator a hinge, in the order of the hinges, so that `ctrl` is `qpos[7:]`."""
    for k, name in enumerate(table.names):
        actuator = spec.add_actuator(
            name=name,
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            forcerange=[-table.torque_limits[k], table.torque_limits[k]],
        )
        actuator.set_to_position(
            kp=float(table.stiffness[k]), kv=float(DAMPING_RATIO * table.stiffness[k])
        )


def _add_geom(body: mujoco.MjsBody, solid: Solid) -> None:
    side = solid.joint.partition("_")[0]
    colour = {"left": _LEFT, "right": _RIGHT}.get(side, _TRUNK)
    start, end = np.array(solid.start), np.array(solid.end)
    shape = (
        {
            "type": mujoco.mjtGeom.mjGEOM_BOX,
            "pos": (start + end) / 2,
            "size": (end - start) / 2,
        }
        if solid.is_box
        else {
            "type": mujoco.mjtGeom.mjGEOM_CAPSULE,
            "fromto": np.concatenate([start, end]),
            "size": [solid.radius, 0.0, 0.0],
        }
    )
    body.add_geom(name=solid.joint, mass=solid.mass, rgba=colour, **shape)


def add_scene(spec: mujoco.MjSpec) -> None:
    """Add floor, sky and light to a model."""
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1280, 960
    # software renderers are common where this runs; shadows would take most of their time
    spec.visual.quality.offsamples = 2
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.98, 0.98, 1.0],
        rgb2=[0.80, 0.85, 0.90],
        width=256,
        height=256,
    )
    spec.add_texture(
        name="grid",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=[0.90, 0.92, 0.94],
        rgb2=[0.85, 0.87, 0.90],
        markrgb=[0.75, 0.78, 0.81],
        width=256,
        height=256,
    )
    material = spec.add_material(name="grid", texrepeat=[1, 1], texuniform=True)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "grid"
    spec.worldbody.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 0.05], material="grid"
    )
    spec.worldbody.add_light(
        pos=[0, 0, 4],
        dir=[0.2, 0.3, -1],
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        castshadow=False,
    )


def _arms_lowered(angle: float) -> Array:
    """Return the hinges of the T-pose with the arms lowered by an angle [rad]."""
    table = hinge_table()
    angles = np.zeros(len(table.names))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        tilt = table.tilts[table.joints.index(CANONICAL.index(f"{side}_shoulder"))]
        angles[table.names.index(f"{side}_shoulder_x")] = -sign * angle - tilt
    return angles


@cache
def _overlaps_at_rest() -> tuple[tuple[str, str], ...]:
    """Pairs of bodies that touch when nothing is wrong: arms level, half way down, hanging."""
    model = _bodies(scene=False).compile()
    data = mujoco.MjData(model)
    pairs: set[tuple[int, int]] = set()
    for angle in (0.0, _ARMS_DOWN / 2, _ARMS_DOWN):
        data.qpos[7:] = _arms_lowered(angle)
        mujoco.mj_forward(model, data)
        for contact in data.contact:
            bodies = model.geom_bodyid[contact.geom]
            pairs.add((int(bodies.min()), int(bodies.max())))
    return tuple((model.body(a).name, model.body(b).name) for a, b in sorted(pairs))
