"""What the sampler keeps to: given frames and parts, and places of the root."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from motiondiffuse_ros.diffusion.constraints import Constraint
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.root_path import PathPoint
from motiondiffuse_ros.robots.time_scaling import come_to_rest
from motiondiffuse_ros.robots.trajectory_builder import STOP_WINDOW
from motiondiffuse_ros.waypoint import Waypoint

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Kept:
    """A motion of which the sampled one keeps a part.

    Attributes:
        motion: As long as what is sampled, at its rate; starts over the origin, facing +x.
        rows: Frames of which everything is kept [T], bool.
        columns: Features that are kept in all frames [D], bool.
        points: Where the root has to be so that kept frames are in their places.
    """

    motion: Motion = field(repr=False)
    rows: Flags = field(repr=False)
    columns: Flags = field(repr=False)
    points: tuple[PathPoint, ...] = ()

    @property
    def mask(self) -> Flags:
        """What is kept [T, D], bool."""
        return self.rows[:, None] | self.columns


def constraints(
    pipeline: MotionPipeline, kept: Kept | None, points: Sequence[PathPoint], frames: int
) -> tuple[Constraint, ...]:
    """Return what the sampler has to keep to, in the order in which it is imposed.

    Args:
        pipeline: Knows the features.
        kept: A motion of which a part is kept.
        points: Places of the root beyond those of `kept`, later than them.
        frames: Length of what is sampled.

    Raises:
        RequestError: If the weights' features cannot be kept to places.
    """
    out: list[Constraint] = []
    places = (*(kept.points if kept else ()), *points)
    if kept is not None and kept.rows.any():
        out.append(pipeline.easing(kept.motion, kept.rows))
    if places:
        out.append(pipeline.on_path(places, frames))
    if kept is not None:
        # what bending the path did to kept frames is undone; the path between them stays bent
        out.append(pipeline.keeping(kept.motion, kept.mask))
    return tuple(out)


def path_points(
    waypoints: Sequence[Waypoint], duration: float, fps: float, seam: PathPoint | None = None
) -> tuple[PathPoint, ...]:
    """Return a request's waypoints as points of what is sampled.

    A trajectory slows to rest at its end and gives up the last of the motion's path. Where a
    waypoint falls into that time, the root is to be there from when the trajectory has passed as
    much, so that both motion and trajectory meet it.

    Args:
        waypoints: Over where the motion starts, facing +x there.
        duration: Of the motion, s.
        fps: Rate of the model, Hz.
        seam: Where the motion starts in what is sampled, if not at its first frame.
    """
    seam = seam or PathPoint(0, 0.0, 0.0, 0.0)
    heading = seam.heading or 0.0
    turn = rot.about_axis(2, np.array(heading))
    window = min(STOP_WINDOW, duration)
    points: dict[int, PathPoint] = {}
    for waypoint in waypoints:
        x, y, _ = rot.rotate(turn, np.array([waypoint.x, waypoint.y, 0.0])).tolist()
        passed = float(come_to_rest(np.array([waypoint.time]), duration, window)[0])
        for time in (passed, waypoint.time):
            frame = max(round(time * fps), 1) + seam.frame
            points[frame] = PathPoint(
                frame,
                x + seam.x,
                y + seam.y,
                None if waypoint.heading is None else waypoint.heading + heading,
            )
    if points and seam.frame > 0:
        points[seam.frame] = seam  # what comes before it is not bent
    return tuple(points[frame] for frame in sorted(points))
