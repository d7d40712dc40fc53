"""Pieces of a motion, planned one after another; the first is executed while others are sampled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

from rclpy.duration import Duration
from rclpy.time import Time

from motiondiffuse_ros.joined_plan import join_plans, progress_of_piece
from motiondiffuse_ros.msg import MotionPlan
from motiondiffuse_ros.pieces import Piece, nth_seed
from motiondiffuse_ros.planner import Plan, Progress
from motiondiffuse_ros.request import MotionRequest


@dataclass(frozen=True, eq=False)
class Published:
    """A plan that is on its way to be executed.

    Attributes:
        plan: As published.
        message: That was published.
    """

    plan: Plan
    message: MotionPlan

    @property
    def begins(self) -> Time:
        """When its first point is due."""
        return Time.from_msg(self.message.header.stamp)


class PlanPiece(Protocol):
    """Plans and publishes one piece; one that follows takes over at a time from what runs then."""

    def __call__(
        self,
        request: MotionRequest,
        follows: Time | None,
        *,
        progress: Callable[[Progress], None],
        cancelled: Callable[[], bool],
    ) -> Published:
        """Do the work."""
        ...


def plan_in_pieces(
    pieces: Sequence[Piece],
    plan_piece: PlanPiece,
    *,
    progress: Callable[[Progress], None],
    cancelled: Callable[[], bool],
    drop: Callable[[], None],
) -> list[Published]:
    """Plan and publish pieces in their order.

    Args:
        pieces: Of one request.
        plan_piece: Called for each.
        progress: Told where the whole request stands.
        cancelled: Asked before every denoising step.
        drop: Called if not all were planned and some were published.

    Raises:
        MotionDiffuseError: The error that ended a piece.
    """
    made: list[Published] = []
    try:
        for i, piece in enumerate(pieces):
            request, follows = piece.request, None
            if made:
                elapsed = piece.start - pieces[i - 1].start
                follows = made[-1].begins + Duration(nanoseconds=round(1e9 * elapsed))
                request = request.with_defaults(seed=nth_seed(made[0].plan.seed, i))

            share = progress_of_piece(progress, i, len(pieces))
            made.append(plan_piece(request, follows, progress=share, cancelled=cancelled))
    except BaseException:
        if made:
            drop()
        raise
    return made


def whole(request: MotionRequest, made: Sequence[Published], *, track: bool) -> Plan:
    """Return what published pieces are together; see `join_plans`."""
    seams = [(after.begins - before.begins).nanoseconds * 1e-9 for before, after in pairwise(made)]
    return join_plans(request, [piece.plan for piece in made], seams, track=track)
