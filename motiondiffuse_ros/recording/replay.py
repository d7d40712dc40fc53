"""Planning again what was recorded, and comparing."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from motiondiffuse_ros.diffusion.threads import sharing
from motiondiffuse_ros.errors import RecordingError
from motiondiffuse_ros.joined_plan import join_plans, progress_of_piece
from motiondiffuse_ros.planner import Origin, Plan, Planner, Progress
from motiondiffuse_ros.recording import arrays
from motiondiffuse_ros.recording.record import Record
from motiondiffuse_ros.recording.robot_hashes import MODEL, robot_hashes
from motiondiffuse_ros.recording.surroundings import surroundings
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import JointTrajectory, get_robot


def planner_of(
    record: Record, weights: Path | None = None, text_encoder: Path | None = None
) -> Planner:
    """Return a planner of the recorded settings.

    Args:
        record: What is to be planned again.
        weights: Checkpoint folder instead of the recorded one.
        text_encoder: Folder of the text encoder instead of the recorded one.

    Raises:
        RecordingError: If a file of weights, text encoder, critic or robot is not the recorded one.
        CheckpointError: If there are no weights.
        TextEncoderError: If there is no text encoder.
        RobotError: If there is no such robot.
    """
    robot = robot_hashes(get_robot(record.request.robot))
    if record.surroundings.get("mujoco") != surroundings()["mujoco"]:
        robot |= {k: v for k, v in record.hashes.items() if k == MODEL}  # not to be compared
    settings = replace(
        record.settings,
        weights=weights or record.settings.weights,
        text_encoder=text_encoder or record.settings.text_encoder,
    )
    planner = Planner(settings)
    found = planner.hashes | robot
    for name, recorded in record.hashes.items():
        if (here := found.get(name, "")) != recorded:
            raise RecordingError(
                f"{name} is not the one that was recorded: SHA-256 {here[:12] or 'of none'}…, "
                f"recorded {recorded[:12]}…"
            )
    return planner


def doubts(record: Record) -> list[str]:
    """Return what of code, libraries and machine is another than when it was recorded."""
    return [
        f"{name}: recorded with {record.surroundings.get(name, 'unknown')[:60]}, here {here[:60]}"
        for name, here in surroundings().items()
        if record.surroundings.get(name) != here
    ]


def replay(
    record: Record, planner: Planner, progress: Callable[[Progress], None] | None = None
) -> Plan:
    """Plan again what was recorded, with as many threads as then; piece by piece if it was so.

    Raises:
        MotionDiffuseError: As `Planner.plan`.
        RecordingError: If the start that was recorded cannot be read.
    """
    origin = record.origin
    shared = replace(record.threads, of_products=max(1, min(record.threads.of_products, 1024)))
    with sharing(shared):  # sums are cut as they were then
        if origin.pieces:
            return _joined(planner, origin, progress)
        with _request(record) as request:
            return _planned(planner, request, origin, progress)


def _planned(
    planner: Planner,
    request: MotionRequest,
    origin: Origin,
    progress: Callable[[Progress], None] | None,
    track: bool | None = None,
) -> Plan:
    plan = planner.plan(request, start=origin.start, track=track, progress=progress)
    for state in origin.restarts:
        plan = planner.restarted(plan, state)
    return plan


def _joined(planner: Planner, origin: Origin, progress: Callable[[Progress], None] | None) -> Plan:
    count, plans = len(origin.pieces), []
    for i, piece in enumerate(origin.pieces):
        told = None if progress is None else progress_of_piece(progress, i, count)
        plans.append(_planned(planner, piece.request, piece.origin, told, track=False))
    seams = [piece.begins for piece in origin.pieces[1:]]
    return join_plans(origin.given, plans, seams, track=planner.config.track)


def difference(record: Record, trajectory: JointTrajectory) -> str:
    """Return where and by how much a trajectory differs from the recorded one; empty if nowhere."""
    if trajectory.joint_names != record.joint_names:
        return "other joints"
    recorded, found = record.trajectory, arrays.of_trajectory(trajectory)
    if set(recorded) != set(found):
        return f"recorded are {', '.join(sorted(recorded))}; now {', '.join(sorted(found))}"
    points = len(trajectory.times)
    if len(recorded["times"]) != points:
        return f"{len(recorded['times'])} points were recorded, now there are {points}"
    differing = []
    for name, values in found.items():
        before = recorded[name]
        if before.dtype != values.dtype or before.shape != values.shape:
            differing.append(
                f"{name} {before.dtype}{before.shape}, now {values.dtype}{values.shape}"
            )
        elif before.tobytes() != values.tobytes():
            differing.append(f"{name} {_where(before, values, trajectory)}")
    return "; ".join(differing)


def _where(before: np.ndarray, now: np.ndarray, trajectory: JointTrajectory) -> str:
    # by bits: -0.0 is another number than 0.0 here
    rows = (before.view(np.uint64) != now.view(np.uint64)).reshape(len(before), -1).any(axis=1)
    first = int(np.flatnonzero(rows)[0])
    return (
        f"at {rows.sum()} of {len(rows)} points from {trajectory.times[first]:.2f} s on, "
        f"by up to {np.abs(now - before).max():.3g}"
    )


@contextmanager
def _request(record: Record) -> Iterator[MotionRequest]:
    """Return the request; a motion that was edited is there as it was then."""
    edit = record.request.edit
    if edit is None:
        yield record.request
        return
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / Path(edit.motion).name
        file.write_bytes(record.edited)
        yield replace(record.request, edit=replace(edit, motion=str(file)))
