"""One motion is planned at a time, in a thread of its own; one more may wait, or take over."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

from motiondiffuse_ros.errors import Cancelled, ErrorCode, MotionDiffuseError
from motiondiffuse_ros.planner import Progress
from motiondiffuse_ros.request import MotionRequest

Result = TypeVar("Result")
Result_co = TypeVar("Result_co", covariant=True)


class Superseded(MotionDiffuseError):
    """A newer request took the place of this one."""

    code = ErrorCode.SUPERSEDED


class NotActive(MotionDiffuseError):
    """The node is not in the lifecycle state `active`, or left it."""

    code = ErrorCode.NOT_ACTIVE


def _ignore(progress: Progress) -> None:
    pass


def _never() -> bool:
    return False


@dataclass(frozen=True, eq=False)
class Job(Generic[Result]):
    """A request on its way to a plan.

    Attributes:
        request: What to plan.
        progress: Told about every step, from the planning thread.
        withdrawn: Whether whoever asked has changed their mind; polled.
        outcome: The result, or the error that ended it.
    """

    request: MotionRequest
    progress: Callable[[Progress], None] = _ignore
    withdrawn: Callable[[], bool] = _never
    outcome: Future[Result] = field(default_factory=Future)


class Work(Protocol[Result_co]):
    """What turns a request into a result; raises `Cancelled` soon after `cancelled()` holds."""

    def __call__(
        self,
        request: MotionRequest,
        *,
        progress: Callable[[Progress], None],
        cancelled: Callable[[], bool],
    ) -> Result_co:
        """Do the work."""
        ...


class PlanningQueue(Generic[Result]):
    """Runs jobs one after another; of those that wait, only the newest is kept."""

    def __init__(self, work: Work[Result], preempt: Callable[[], bool] = _never) -> None:
        """Start the thread that calls `work`.

        Args:
            work: Called for one job after another.
            preempt: Whether a newer job also ends the one that is worked on; asked at `submit`.
        """
        self._work, self._preempt = work, preempt
        self._overtaken: Job[Result] | None = None
        self._pending: Job[Result] | None = None
        self._active: Job[Result] | None = None
        self._closed: MotionDiffuseError | None = None
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="planning", daemon=True)
        self._thread.start()

    @property
    def busy(self) -> bool:
        """Whether a job is being worked on or waits."""
        with self._changed:
            return self._active is not None or self._pending is not None

    def submit(self, job: Job[Result]) -> None:
        """Queue a job; one that waits already ends with `Superseded`, as does an active one if
        newer jobs preempt.

        Raises:
            MotionDiffuseError: The error given to `close`, if the queue was closed.
        """
        with self._changed:
            if self._closed is not None:
                raise self._closed
            replaced, self._pending = self._pending, job
            if self._preempt():
                self._overtaken = self._active
            self._changed.notify_all()
        if replaced is not None:
            replaced.outcome.set_exception(
                Superseded("a newer request took the place of this one before it was started")
            )

    def sweep(self) -> None:
        """End the waiting job if it was withdrawn. To be called now and then."""
        with self._changed:
            if self._pending is None or not self._pending.withdrawn():
                return
            job, self._pending = self._pending, None
        job.outcome.set_exception(Cancelled("withdrawn before it was started"))

    def close(self, reason: MotionDiffuseError) -> None:
        """End all jobs with an error and wait for the thread. Later jobs are refused with it."""
        with self._changed:
            self._closed = reason
            job, self._pending = self._pending, None
            self._changed.notify_all()
        if job is not None:
            job.outcome.set_exception(reason)
        self._thread.join()

    def _next(self) -> Job[Result] | None:
        with self._changed:
            self._active = None
            self._changed.wait_for(lambda: self._pending is not None or self._closed is not None)
            if self._closed is None:
                self._active, self._pending = self._pending, None
            return self._active

    def _run(self) -> None:
        while (job := self._next()) is not None:
            self._finish(job)

    def _finish(self, job: Job[Result]) -> None:
        def cancelled() -> bool:
            self.sweep()
            return self._closed is not None or self._overtaken is job or job.withdrawn()

        try:
            result = self._work(job.request, progress=job.progress, cancelled=cancelled)
        except Cancelled as error:
            job.outcome.set_exception(self._closed or self._reason(job) or error)
        # an error of any kind belongs to whoever waits for the outcome; the thread goes on
        except Exception as error:
            job.outcome.set_exception(error)
        else:
            job.outcome.set_result(result)

    def _reason(self, job: Job[Result]) -> MotionDiffuseError | None:
        if self._overtaken is not job:
            return None
        return Superseded("a newer request took the place of this one while it was worked on")
