"""From the plan that is executed to the next one without a jump.

Planning takes seconds. So the seam is set ahead, to when the new plan is expected: the running plan
goes on until there, and the new motion continues what it will have done. A plan that comes later
than expected starts from the state that the running one has by then.
"""

from __future__ import annotations

from dataclasses import dataclass

from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.time import Time

from motiondiffuse_ros.continuation import LEAD_IN, Start
from motiondiffuse_ros.planner import Plan, Planner
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.ros.reference import Playing, ReferenceStream

RESERVE = 1.25
"""The seam is set at this multiple of the time that planning is expected to take."""

SWITCH = 0.1
"""Least time between a late plan's publication and its first point [s]."""

_ATTEMPTS = 3


@dataclass(frozen=True, eq=False)
class Seam:
    """Where a plan joins the one that is executed.

    Attributes:
        playing: What is executed until then.
        time: Of the seam.
        start: The state and the motion there.
        resets: Of the clock, when the seam was set.
    """

    playing: Playing
    time: Time
    start: Start
    resets: int


class Continuity:
    """Finds seams for new plans and fits late plans to the running one."""

    def __init__(self, planner: Planner, reference: ReferenceStream, clock: Clock) -> None:
        """Take whose plans are executed, what executes them, and the clock that it goes by."""
        self._planner, self._reference, self._clock = planner, reference, clock
        self._pace: float | None = None

    def seam(self, request: MotionRequest, at: Time | None = None) -> Seam | None:
        """Return where a plan for a request is to join; None if nothing is executed.

        Args:
            request: Of which it is known how long a plan takes.
            at: Not before this time, if that can be met; None = as soon as possible.
        """
        resets = self._reference.resets
        latest, robot = self._reference.playing, get_robot(request.robot)
        if latest is None or self._pace is None:
            return None
        if latest.states.trajectory.joint_names != robot.joint_names:
            return None
        expected = RESERVE * self._pace * _work(request) + SWITCH
        time = self._clock.now() + Duration(nanoseconds=round(expected * 1e9))
        if at is not None:
            time = _later(time, at)
        playing = latest.at(time)
        time = _later(time, playing.start)
        elapsed = playing.elapsed(time)
        states = playing.states
        lead_in = states.motion_up_to(robot, elapsed, LEAD_IN, self._planner.fps)
        return Seam(playing, time, Start(lead_in, states.at(elapsed)), resets)

    def learn(self, plan: Plan) -> None:
        """Remember how long a plan took."""
        self._pace = plan.timings_s["total"] / _work(plan.request)

    def fitted(self, plan: Plan, seam: Seam) -> tuple[Plan, Time | None]:
        """Return a plan whose first point can still be met, and when that is due.

        None is at once: the clock was reset meanwhile, and nothing is executed any more.
        """
        if self._reference.resets != seam.resets:
            return plan, None
        now = self._clock.now()
        if now.nanoseconds + SWITCH * 0.5e9 <= seam.time.nanoseconds:
            return plan, seam.time
        reserve = SWITCH + 2.0 * plan.timings_s["retargeting"]
        time = seam.time
        for _ in range(_ATTEMPTS):
            time = self._clock.now() + Duration(nanoseconds=round(reserve * 1e9))
            playing = (self._reference.playing or seam.playing).at(time)
            plan = self._planner.restarted(plan, playing.states.at(playing.elapsed(time)))
            if self._clock.now().nanoseconds <= time.nanoseconds:
                break
            reserve *= 2.0
        return plan, time


def _later(one: Time, other: Time) -> Time:
    return max(one, other, key=lambda time: time.nanoseconds)


def _work(request: MotionRequest) -> float:
    """Return the size of a request, in units of which only the ratio counts."""
    assert request.steps is not None
    assert request.candidates is not None
    return (request.steps + 10.0) * request.candidates * (request.total_seconds + 2.0)
