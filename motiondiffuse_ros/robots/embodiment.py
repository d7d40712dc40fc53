"""How a robot's body compares with the canonical skeleton, measured in the pose they share."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import mujoco
import numpy as np

from motiondiffuse_ros.errors import RobotError
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import LEG_LENGTH, SIDES
from motiondiffuse_ros.robots.robot import Robot, solid_points

_SOLE = 0.015
"""Points of a foot up to this above its lowest one belong to the sole [m]."""


@dataclass(frozen=True, eq=False)
class Embodiment:
    """Proportions of a robot. "Frame of a site" is that site's axes in the robot's model.

    Attributes:
        scale: Length of the robot's legs over that of the skeleton's.
        turns: From the canonical T-pose (no rotation) to the frame of each mapped joint's site
            in it, [4] by canonical joint, wxyz.
        hip_centre: Middle of the hips in the frame of the pelvis' site [3], m.
        half_hip_width: Half the distance of the hips, m.
        waist: From the pelvis to the middle of the joints of the waist, in the frame of the
            pelvis' site [3], m.
        chest: From there to the chest, in the frame of the chest's (spine3) site [3], m.
        shoulders: In the frame of the chest's site, [3] by side, m.
        upper_arm: Length by side, m.
        forearm: Length by side, m.
        ankle_height: Of the ankle above the sole of a level foot, m.
        soles: Corners of the sole in the frame of the ankle's site, rear ones first, [4, 3] by
            side, m.
    """

    scale: float
    turns: dict[str, Array] = field(repr=False)
    hip_centre: Array = field(repr=False)
    half_hip_width: float
    waist: Array = field(repr=False)
    chest: Array = field(repr=False)
    shoulders: dict[str, Array] = field(repr=False)
    upper_arm: dict[str, float] = field(repr=False)
    forearm: dict[str, float] = field(repr=False)
    ankle_height: float
    soles: dict[str, Array] = field(repr=False)


@cache
def embodiment(robot: Robot) -> Embodiment:
    """Measure a robot that is retargeted by inverse kinematics.

    Raises:
        RobotError: If a limb has no length, or a foot nothing that could touch the floor.
    """
    model, data = robot.model, mujoco.MjData(robot.model)
    t_pose = robot.description.t_pose
    data.qpos[7:] = [t_pose.get(name, 0.0) for name in robot.joint_names]
    mujoco.mj_kinematics(model, data)
    sites = {joint: data.site(site) for joint, site in robot.description.body_map.items()}
    place = {joint: site.xpos.copy() for joint, site in sites.items()}
    turns = {
        joint: rot.from_matrix(site.xmat.reshape(1, 3, 3))[0].copy()
        for joint, site in sites.items()
    }

    def length(start: str, end: str) -> float:
        found = float(np.linalg.norm(place[end] - place[start]))
        if found < 0.01:
            raise RobotError(f"robot '{robot.name}': bodies {start} and {end} lie at one point")
        return found

    def inside(frame: str, point: Array) -> Array:
        return rot.rotate(rot.conjugate(turns[frame]), point - place[frame])

    waist = _waist(robot, data, place["pelvis"])
    legs = [length(f"{s}_hip", f"{s}_knee") + length(f"{s}_knee", f"{s}_ankle") for s in SIDES]
    corners = {side: _sole(robot, data, side) for side in SIDES}
    return Embodiment(
        scale=float(np.mean(legs)) / LEG_LENGTH,
        turns=turns,
        hip_centre=inside("pelvis", 0.5 * (place["left_hip"] + place["right_hip"])),
        half_hip_width=0.5 * float(abs(place["left_hip"][1] - place["right_hip"][1])),
        waist=inside("pelvis", waist),
        chest=rot.rotate(rot.conjugate(turns["spine3"]), place["spine3"] - waist),
        shoulders={side: inside("spine3", place[f"{side}_shoulder"]) for side in SIDES},
        upper_arm={side: length(f"{side}_shoulder", f"{side}_elbow") for side in SIDES},
        forearm={side: length(f"{side}_elbow", f"{side}_wrist") for side in SIDES},
        ankle_height=float(
            np.mean([place[f"{side}_ankle"][2] - corners[side][:, 2].mean() for side in SIDES])
        ),
        soles={side: inside(f"{side}_ankle", corners[side]) for side in SIDES},
    )


def _waist(robot: Robot, data: mujoco.MjData, pelvis: Array) -> Array:
    """Return the middle of the joints between pelvis and chest in the world [3], m."""
    model, sites = robot.model, robot.description.body_map
    between = set[int]()
    for joint in ("pelvis", "spine3"):
        body, above = int(model.site(sites[joint]).bodyid[0]), set[int]()
        while body > 0:
            above.add(body)
            body = int(model.body_parentid[body])
        between ^= above
    anchors = [data.xanchor[j] for j in range(1, model.njnt) if int(model.jnt_bodyid[j]) in between]
    return np.mean(anchors, axis=0) if anchors else pelvis


def _sole(robot: Robot, data: mujoco.MjData, side: str) -> Array:
    """Return the corners of what can touch the floor, in the world of the T-pose [4, 3], m."""
    model = robot.model
    site = model.site(robot.description.body_map[f"{side}_ankle"])
    foot = int(site.bodyid[0])
    solids = [
        points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        for geom in np.flatnonzero(model.geom_bodyid == foot)
        if (points := solid_points(model, int(geom))) is not None
    ]
    if not solids:
        body = model.body(foot).name
        raise RobotError(
            f"robot '{robot.name}': the body {body} of {side}_ankle has no solid that collides"
        )
    points = np.concatenate(solids)
    low = points[:, 2].min()
    sole = points[points[:, 2] < low + _SOLE]
    (x0, y0), (x1, y1) = sole[:, :2].min(axis=0), sole[:, :2].max(axis=0)
    return np.array([[x0, y0, low], [x0, y1, low], [x1, y0, low], [x1, y1, low]])
