"""The humanoid that tracking by sampling simulates, with sensors for what its cost weighs."""

from __future__ import annotations

from functools import cache

import mujoco

from motiondiffuse_ros.motion import CANONICAL
from motiondiffuse_ros.physics.humanoid import build_humanoid

TIMESTEP = 0.005
"""Twice that of the verdict's simulation, which the implicit integrator bears [s]."""

_JOINTS = len(CANONICAL.names)
POSITIONS = slice(0, 3 * _JOINTS)
ORIENTATION = slice(POSITIONS.stop, POSITIONS.stop + 4)
CENTRE = slice(ORIENTATION.stop, ORIENTATION.stop + 3)
VELOCITY = slice(CENTRE.stop, CENTRE.stop + 3)
MOMENTUM = slice(VELOCITY.stop, VELOCITY.stop + 3)

DIVERGED = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


@cache
def tracking_model() -> mujoco.MjModel:
    """Return the compiled model. Shared: do not change it.

    Sensors: world positions of the joints, the root's orientation wxyz, and position, velocity
    and angular momentum of the centre of mass, where the slices of this module say.
    """
    spec = build_humanoid(scene=True)
    spec.option.timestep = TIMESTEP
    kind, thing = mujoco.mjtSensor, mujoco.mjtObj
    for name in CANONICAL.names:
        spec.add_sensor(type=kind.mjSENS_FRAMEPOS, objtype=thing.mjOBJ_XBODY, objname=name)
    root = CANONICAL.names[0]
    spec.add_sensor(type=kind.mjSENS_FRAMEQUAT, objtype=thing.mjOBJ_XBODY, objname=root)
    for sensor in (kind.mjSENS_SUBTREECOM, kind.mjSENS_SUBTREELINVEL, kind.mjSENS_SUBTREEANGMOM):
        spec.add_sensor(type=sensor, objtype=thing.mjOBJ_BODY, objname=root)
    model = spec.compile()
    # MuJoCo's silent reset on divergence would hide it
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    return model
