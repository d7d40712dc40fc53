"""The plan that pieces make together, as it is executed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array, continuous
from motiondiffuse_ros.physics.report import assess
from motiondiffuse_ros.planner import Origin, PieceOrigin, Plan, Progress
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import JointTrajectory, get_robot
from motiondiffuse_ros.robots.trajectory import Source
from motiondiffuse_ros.robots.trajectory_state import TrajectoryState

_ROUNDING = 1e-9


def join_plans(
    request: MotionRequest,
    plans: Sequence[Plan],
    seams: Sequence[float],
    *,
    track: bool = False,
) -> Plan:
    """Join plans that take over from one another, and judge the motion as a whole.

    Args:
        request: What they fulfil together.
        plans: One or more, for one robot.
        seams: Time in each plan but the last at which the next one begins [s].
        track: Whether the whole is judged by simulated tracking too.
    """
    first = plans[0]
    last = plans[-1]
    motion, offset = _joined_motion(plans, seams, last.motion)
    # what the last trajectory was made from goes on where that comes to stand
    source = last.trajectory.source
    if source is not None:
        source = replace(source, motion=_joined_motion(plans, seams, source.motion)[0])
    robot = get_robot(first.robot)
    limits = robot if robot.is_canonical else None
    report = assess(motion, segments=request.segments, robot=limits, track=track)
    matches = [plan.text_match for plan in plans if plan.text_match is not None]
    return replace(
        first,
        request=request.with_defaults(
            duration=request.total_seconds,
            seed=first.seed,
            guidance_scale=first.request.guidance_scale,
            steps=first.request.steps,
            candidates=first.request.candidates,
        ),
        motion=motion,
        trajectory=_joined_trajectory([plan.trajectory for plan in plans], seams, source, offset),
        report=report,
        timings_s={
            stage: sum(plan.timings_s[stage] for plan in plans) for stage in first.timings_s
        },
        text_match=float(np.mean(matches)) if matches else None,
        origin=_joined_origin(request, plans, seams),
    )


def progress_of_piece(
    progress: Callable[[Progress], None], index: int, count: int
) -> Callable[[Progress], None]:
    """Return who is told how far one piece of several is, and says how far that is in all."""
    return lambda now: progress(replace(now, fraction=(index + now.fraction) / count))


def _joined_origin(request: MotionRequest, plans: Sequence[Plan], seams: Sequence[float]) -> Origin:
    return Origin(
        given=request,
        start=plans[0].origin.start,
        pieces=tuple(
            PieceOrigin(plan.request, plan.origin, begins)
            for plan, begins in zip(plans, (0.0, *seams), strict=True)
        ),
    )


def _joined_motion(
    plans: Sequence[Plan], seams: Sequence[float], last: Motion
) -> tuple[Motion, float]:
    """Return what the body does, in the end a last motion, and when that begins [s]."""
    robot = get_robot(plans[0].robot)
    done = [
        TrajectoryState(plan.trajectory).motion_up_to(robot, seam, seam, last.fps)
        for plan, seam in zip(plans, seams, strict=False)
    ]
    parts = [motion.slice(0, motion.frames - 1) for motion in done if motion.frames > 1] + [last]
    motion = replace(
        last,
        root=np.concatenate([part.root for part in parts]),
        rotations=np.concatenate([part.rotations for part in parts]),
    )
    return motion, (motion.frames - last.frames) / last.fps


def _joined_trajectory(
    trajectories: Sequence[JointTrajectory],
    seams: Sequence[float],
    source: Source | None,
    offset: float,
) -> JointTrajectory:
    kept = [
        trajectory.times < seam - _ROUNDING
        for trajectory, seam in zip(trajectories, seams, strict=False)
    ] + [np.ones(len(trajectories[-1].times), dtype=bool)]
    begins = [0.0, *accumulate(seams)]

    def joined(values: Sequence[Array]) -> Array:
        return np.concatenate([v[rows] for v, rows in zip(values, kept, strict=True)])

    times = joined([t.times + begin for t, begin in zip(trajectories, begins, strict=True)])
    positions = joined([t.positions for t in trajectories])
    velocities = joined([t.velocities for t in trajectories])
    for point in np.cumsum([rows.sum() for rows in kept])[:-1]:  # its neighbours are of two plans
        velocities[point] = (positions[point + 1] - positions[point - 1]) / (
            times[point + 1] - times[point - 1]
        )
    accelerations = [t.accelerations for t in trajectories if t.accelerations is not None]
    last = trajectories[-1]
    if source is not None:
        tail = offset + source.times
        source = replace(source, times=np.concatenate([times[: len(times) - len(tail)], tail]))
    return JointTrajectory(
        joint_names=last.joint_names,
        times=times,
        positions=positions,
        velocities=velocities,
        root_position=joined([t.root_position for t in trajectories]),
        root_orientation=continuous(joined([t.root_orientation for t in trajectories])),
        root_linear_velocity=joined([t.root_linear_velocity for t in trajectories]),
        root_angular_velocity=joined([t.root_angular_velocity for t in trajectories]),
        notes=(
            f"planned in {len(trajectories)} pieces",
            *(note for trajectory in trajectories for note in trajectory.notes),
        ),
        accelerations=joined(accelerations) if len(accelerations) == len(trajectories) else None,
        source=source,
    )
