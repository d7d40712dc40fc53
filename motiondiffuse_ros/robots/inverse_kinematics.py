"""Poses of a robot that follow a motion, frame after frame, by mink's differential kinematics."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mink
import numpy as np

from motiondiffuse_ros.errors import Cancelled, RobotError
from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.motion.skeleton import ANKLE_HEIGHT, LEG_LENGTH, SIDES
from motiondiffuse_ros.robots.clearance import Clearance
from motiondiffuse_ros.robots.embodiment import Embodiment, embodiment
from motiondiffuse_ros.robots.foot_paths import FootPath
from motiondiffuse_ros.robots.joint_box import JointBox
from motiondiffuse_ros.robots.robot import Robot
from motiondiffuse_ros.robots.self_collision import self_collision_pairs

SOLVER = "daqp"

LIMIT_MARGIN = np.radians(2.5)
"""Joints stay this far inside their ranges: trajectories bend what comes nearer."""

KNEE_RESERVE = 0.015
"""Hips are lowered by this part of the leg, so that straight legs have a way to give."""

_MOST_ITERATIONS, _FIRST_ITERATIONS = 6, 60
_SETTLED = 0.02  # largest change of a joint in a step that is the last one [rad]
_PACE = 0.65  # of the speed limits, from frame to frame; splines through the frames overshoot
_TOLD_EVERY = 10  # frames between two reports of progress
_DT = 1.0  # tasks and limits here speak of steps, not of speeds
_DAMPING = 5e-4
_REST_COST = 0.04

_FOOT_ORIENTATION = (0.5, 4.0)  # cost in the air and on the floor
# (position, orientation): metres weigh as much as radians at a tenth of a metre or so
_COSTS = {
    "pelvis": (8.0, 0.8),
    "spine3": (0.0, 1.2),
    "ankle": (30.0, _FOOT_ORIENTATION[1]),
    "elbow": (2.0, 0.0),
    "wrist": (3.0, 0.06),
    "head": (0.0, 0.3),
}


class InverseKinematics:
    """The tasks and limits of one robot; poses are warm-started from the one before."""

    def __init__(self, robot: Robot) -> None:
        """Set the tasks up."""
        self.robot, self.body = robot, embodiment(robot)
        self._configuration = mink.Configuration(robot.model)
        self._tasks = {
            joint: mink.FrameTask(site, "site", *costs, lm_damping=1e-3)
            for joint, site in robot.description.body_map.items()
            if (costs := _COSTS.get(joint.rpartition("_")[2]))
        }
        self._start = np.concatenate([robot.model.qpos0[:7], robot.rest_positions])
        rest = mink.PostureTask(robot.model, np.r_[np.zeros(6), np.full(_joints(robot), 1.0)])
        rest.cost = _REST_COST * rest.cost
        rest.set_target(self._start)
        self._all_tasks = [*self._tasks.values(), rest]
        margin = _margin(robot)
        self._box = JointBox(robot.lower + margin, robot.upper - margin)
        self._clearance = Clearance(robot, self_collision_pairs(robot))

    def follow(
        self,
        motion: Motion,
        feet: dict[str, FootPath],
        progress: Callable[[float], None] | None = None,
        cancelled: Callable[[], bool] | None = None,
    ) -> Array:
        """Return the robot's `qpos` for every frame [T, 7 + J].

        Args:
            motion: Finite.
            feet: Where the feet go.
            progress: Told the share done, 0 to 1.
            cancelled: Asked before every frame.

        Raises:
            Cancelled: If `cancelled` says so.
            RobotError: If the solver finds no solution.
        """
        targets = _targets(motion, feet, self.body, tuple(self._tasks))
        out = np.empty((motion.frames, self.robot.model.nq))
        qpos = self._start.copy()
        qpos[7:] = np.clip(qpos[7:], *self._box.range)
        reach = _PACE * self.robot.velocity_limits / motion.fps
        before = np.concatenate([qpos[3:7], qpos[:3]])
        for frame in range(motion.frames):
            if cancelled is not None and cancelled():
                raise Cancelled(f"cancelled at frame {frame} of retargeting")
            # the whole body goes along with the pelvis, which leaves less to the legs
            pelvis = targets["pelvis"][frame]
            qpos[:3], qpos[3:7] = _carried(qpos[:3], qpos[3:7], before, pelvis)
            before = pelvis
            if frame:
                self._box.around(qpos[7:], reach)
            self._configuration.update(qpos)
            for joint, task in self._tasks.items():
                task.set_target(mink.SE3(wxyz_xyz=targets[joint][frame]))
            for side in SIDES:
                low, high = _FOOT_ORIENTATION
                cost = low + (high - low) * feet[side].grip[frame]
                self._tasks[f"{side}_ankle"].set_orientation_cost(cost)
            self._solve(_MOST_ITERATIONS if frame else _FIRST_ITERATIONS)
            out[frame] = qpos = self._configuration.q.copy()
            if progress is not None and frame % _TOLD_EVERY == _TOLD_EVERY - 1:
                progress((frame + 1) / motion.frames)
        return out

    def _solve(self, iterations: int) -> None:
        """Improve the pose until it hardly changes."""
        for _ in range(iterations):
            step = self._step()
            self._configuration.integrate_inplace(step, _DT)
            if np.abs(step).max() < _SETTLED:
                break

    def _step(self) -> Array:
        for self._clearance.parting in (True, False):
            try:
                return mink.solve_ik(
                    self._configuration,
                    self._all_tasks,
                    _DT,
                    SOLVER,
                    damping=_DAMPING,
                    limits=[self._box, self._clearance],
                )
            except mink.NoSolutionFound:
                continue
        raise RobotError(f"robot '{self.robot.name}': no pose keeps its limits and clearances")


def _carried(
    position: Array, orientation: Array, before: Array, after: Array
) -> tuple[Array, Array]:
    """Move a base rigidly with a frame that goes from one pose to another [7], wxyz and m."""
    turn = rot.multiply(after[:4], rot.conjugate(before[:4]))
    moved = after[4:] + rot.rotate(turn, position - before[4:])
    return moved, rot.normalise(rot.multiply(turn, orientation))


def _targets(
    motion: Motion, feet: dict[str, FootPath], body: Embodiment, joints: Sequence[str]
) -> dict[str, Array]:
    """Return the pose of every task's site over time [T, 7], wxyz and m."""
    turned = {
        joint: rot.multiply(motion.global_rotations[:, CANONICAL.index(joint)], body.turns[joint])
        for joint in joints
    }
    for side in SIDES:
        ankle = f"{side}_ankle"
        turned[ankle] = rot.multiply(feet[side].rotation, body.turns[ankle])
    place: dict[str, Array] = {joint: np.zeros((motion.frames, 3)) for joint in joints}
    place["pelvis"] = _pelvis(motion, body, turned["pelvis"])
    chest = place["pelvis"] + (
        rot.rotate(turned["pelvis"], body.waist) + rot.rotate(turned["spine3"], body.chest)
    )
    for side in SIDES:
        place[f"{side}_ankle"] = feet[side].ankle
        shoulder = chest + rot.rotate(turned["spine3"], body.shoulders[side])
        place[f"{side}_elbow"] = shoulder + body.upper_arm[side] * _direction(
            motion, f"{side}_shoulder", f"{side}_elbow"
        )
        place[f"{side}_wrist"] = place[f"{side}_elbow"] + body.forearm[side] * _direction(
            motion, f"{side}_elbow", f"{side}_wrist"
        )
    return {
        joint: np.concatenate([rot.normalise(turned[joint]), place[joint]], axis=1)
        for joint in joints
    }


def _pelvis(motion: Motion, body: Embodiment, turned: Array) -> Array:
    """Return where the pelvis has to be for the hips to be on the scaled path [T, 3], m."""
    hips = 0.5 * (motion.joint("left_hip") + motion.joint("right_hip"))
    centre = body.scale * hips
    centre[:, 2] += body.ankle_height - body.scale * (ANKLE_HEIGHT + KNEE_RESERVE * LEG_LENGTH)
    return centre - rot.rotate(turned, body.hip_centre)


def _direction(motion: Motion, start: str, end: str) -> Array:
    return rot.unit(motion.joint(end) - motion.joint(start))


def _joints(robot: Robot) -> int:
    return len(robot.joint_names)


def _margin(robot: Robot) -> float:
    """Return the margin to the limits; a joint with hardly any range keeps some of it."""
    return float(min(LIMIT_MARGIN, 0.2 * (robot.upper - robot.lower).min()))
