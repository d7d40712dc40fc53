"""How strong the joints of a model are."""

from __future__ import annotations

import mujoco
import numpy as np

from motiondiffuse_ros.motion.rotations import Array


def torque_limits(model: mujoco.MjModel) -> Array:
    """Return what joints after the free one and their actuators allow [K], N m; else infinite."""
    limits = np.full(model.njnt, np.inf)
    own = model.jnt_actfrclimited.astype(bool)
    limits[own] = np.abs(model.jnt_actfrcrange[own]).max(axis=1)
    for a in range(model.nu):
        if model.actuator_trntype[a] == mujoco.mjtTrn.mjTRN_JOINT:
            joint, gear = model.actuator_trnid[a, 0], abs(model.actuator_gear[a, 0])
            if model.actuator_forcelimited[a]:
                most = gear * np.abs(model.actuator_forcerange[a]).max()
            elif (
                model.actuator_biastype[a] == mujoco.mjtBias.mjBIAS_NONE
                and (model.actuator_ctrllimited[a])
            ):
                gain = abs(model.actuator_gainprm[a, 0]) * gear
                most = gain * np.abs(model.actuator_ctrlrange[a]).max()
            else:
                continue
            limits[joint] = min(limits[joint], most)
    return limits[1:]
