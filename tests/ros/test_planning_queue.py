"""One job at a time, the newest waits, everybody gets an answer."""

import threading

import pytest

from motiondiffuse_ros.errors import Cancelled, ErrorCode
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.ros.planning_queue import Job, NotActive, PlanningQueue, Superseded

TIMEOUT = 20.0


class Worker:
    """Work that starts and ends when the test says so, and polls like the planner."""

    def __init__(self):
        self.started = threading.Semaphore(0)
        self.go_on = threading.Semaphore(0)

    def __call__(self, request, *, progress, cancelled):
        self.started.release()
        while not self.go_on.acquire(timeout=0.01):
            if cancelled():
                raise Cancelled("within a step")
        if request.segments[0].text == "broken":
            raise ZeroDivisionError("a defect")
        return request.segments[0].text


@pytest.fixture
def worker():
    return Worker()


@pytest.fixture
def queue(worker):
    queue = PlanningQueue(worker)
    yield queue
    queue.close(NotActive("the test is over"))


def job(text, withdrawn=lambda: False):
    return Job(MotionRequest.from_text(text), withdrawn=withdrawn)


def started(worker):
    assert worker.started.acquire(timeout=TIMEOUT)


def test_jobs_are_done_in_turn(queue, worker):
    first, second = job("walk"), job("wave")
    queue.submit(first)
    started(worker)
    queue.submit(second)
    worker.go_on.release()
    started(worker)
    worker.go_on.release()
    assert first.outcome.result(TIMEOUT) == "walk"
    assert second.outcome.result(TIMEOUT) == "wave"


def test_a_newer_job_replaces_the_waiting_one_not_the_active_one(queue, worker):
    active, waiting, newest = job("walk"), job("wave"), job("run")
    queue.submit(active)
    started(worker)
    queue.submit(waiting)
    queue.submit(newest)
    with pytest.raises(Superseded) as error:
        waiting.outcome.result(TIMEOUT)
    assert error.value.code is ErrorCode.SUPERSEDED
    worker.go_on.release(2)
    assert active.outcome.result(TIMEOUT) == "walk"
    assert newest.outcome.result(TIMEOUT) == "run"


def test_a_withdrawn_active_job_ends_within_a_step_and_the_next_starts(queue, worker):
    gone = threading.Event()
    active, waiting = job("walk", gone.is_set), job("wave")
    queue.submit(active)
    started(worker)
    queue.submit(waiting)
    gone.set()
    with pytest.raises(Cancelled):
        active.outcome.result(TIMEOUT)
    worker.go_on.release()
    assert waiting.outcome.result(TIMEOUT) == "wave"


def test_a_withdrawn_waiting_job_ends_while_another_is_worked_on(queue, worker):
    gone = threading.Event()
    active, waiting = job("walk"), job("wave", gone.is_set)
    queue.submit(active)
    started(worker)
    queue.submit(waiting)
    gone.set()
    queue.sweep()
    with pytest.raises(Cancelled):
        waiting.outcome.result(TIMEOUT)
    worker.go_on.release()
    assert active.outcome.result(TIMEOUT) == "walk"


def test_a_defect_reaches_the_caller_and_the_next_job_is_done(queue, worker):
    bad, good = job("broken"), job("walk")
    worker.go_on.release(2)
    queue.submit(bad)
    with pytest.raises(ZeroDivisionError):
        bad.outcome.result(TIMEOUT)
    queue.submit(good)
    assert good.outcome.result(TIMEOUT) == "walk"


def test_closing_ends_all_jobs_with_the_reason_and_refuses_new_ones(worker):
    queue = PlanningQueue(worker)
    active, waiting = job("walk"), job("wave")
    queue.submit(active)
    started(worker)
    queue.submit(waiting)
    queue.close(NotActive("deactivated"))
    for ended in (active, waiting):
        with pytest.raises(NotActive, match="deactivated"):
            ended.outcome.result(TIMEOUT)
    with pytest.raises(NotActive, match="deactivated"):
        queue.submit(job("run"))


def test_where_newer_jobs_preempt_the_active_one_is_superseded(worker):
    queue = PlanningQueue(worker, preempt=lambda: True)
    active, newer = job("walk"), job("wave")
    queue.submit(active)
    started(worker)
    queue.submit(newer)
    with pytest.raises(Superseded, match="while it was worked on"):
        active.outcome.result(TIMEOUT)
    started(worker)
    worker.go_on.release()
    assert newer.outcome.result(TIMEOUT) == "wave"
    queue.close(NotActive("the test is over"))
