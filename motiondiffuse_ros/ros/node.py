"""The lifecycle node `motiondiffuse`: text, requests and goals in, judged trajectories out."""

from __future__ import annotations

import sys
import threading
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from rclpy.action.server import ActionServer, CancelResponse, ServerGoalHandle
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.subscription import Subscription
from rclpy.time import Time
from std_msgs.msg import String

from motiondiffuse_ros.action import GenerateMotion
from motiondiffuse_ros.diffusion.threads import Threads, use_threads
from motiondiffuse_ros.errors import Cancelled, ErrorCode, MotionDiffuseError
from motiondiffuse_ros.memory import return_freed_memory, share_freed_memory
from motiondiffuse_ros.msg import MotionPlan
from motiondiffuse_ros.msg import MotionRequest as MotionRequestMsg
from motiondiffuse_ros.pieces import split
from motiondiffuse_ros.planner import Plan, Planner, Progress
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.ros.continuity import Continuity
from motiondiffuse_ros.ros.conversions import plan_to_message, request_from_message
from motiondiffuse_ros.ros.diagnostics import Diagnostics
from motiondiffuse_ros.ros.goal_feedback import GoalFeedback
from motiondiffuse_ros.ros.parameter_spec import Parameters
from motiondiffuse_ros.ros.parameters import PLANNER_PARAMETERS, complete, planner_config
from motiondiffuse_ros.ros.plan_publisher import PlanPublisher
from motiondiffuse_ros.ros.plan_recorder import PlanRecorder
from motiondiffuse_ros.ros.planning_queue import Job, NotActive, PlanningQueue
from motiondiffuse_ros.ros.present_joints import PresentJoints
from motiondiffuse_ros.ros.qos import COMMANDS, GOALS
from motiondiffuse_ros.ros.spinning import run_node
from motiondiffuse_ros.ros.steady import create_steady_timer
from motiondiffuse_ros.ros.streaming import Published, plan_in_pieces, whole

HEARTBEAT = 0.15
"""Period of the timer that repeats feedback, and ends withdrawn goals not yet started [s]."""

LONGEST_ANSWER = 10.0
"""For which an open goal can keep the node from going down [s]."""

THREADS = 8
"""Of the executor: an active, a waiting and a superseded goal block one each while they wait."""


@dataclass(frozen=True, eq=False)
class _Configured:
    """What `configure` makes and `cleanup` releases."""

    planner: Planner
    publisher: PlanPublisher
    continuity: Continuity
    joints: PresentJoints


class MotionDiffuseNode(LifecycleNode):
    """Plans motions; `configure` loads weights and robot, `activate` takes work.

    Topics (resolved in the node's namespace): in `~/text`, `~/request`; out `~/plan`,
    `~/joint_trajectory`, `~/root_trajectory`, `~/reference`, `/diagnostics`. Action:
    `~/generate_motion`. The inputs exist from the first activation on, so that whoever waits for
    them is not refused.
    """

    def __init__(self) -> None:
        """Declare the parameters; with `autostart`, configure and activate once spinning."""
        super().__init__("motiondiffuse")
        self.settings = Parameters(self, PLANNER_PARAMETERS)
        self._configured: _Configured | None = None
        self._inputs: list[Subscription | ActionServer] = []
        self._queue: PlanningQueue[MotionPlan] | None = None
        self._feedback = GoalFeedback()
        self._outcomes: dict[bytes, Future[MotionPlan]] = {}  # of open goals
        self._answered = threading.Condition()
        self._health = Diagnostics(self)
        self._health.set("warn", "unconfigured")
        self._recorder = PlanRecorder(
            self._health, self.get_logger(), self.get_fully_qualified_name()
        )
        self._group = MutuallyExclusiveCallbackGroup()  # what comes first is queued first
        self._heartbeat = create_steady_timer(self, HEARTBEAT, self._beat)
        if self.settings["autostart"]:
            self._autostart = create_steady_timer(self, 0.0, self._start)

    def _start(self) -> None:
        self._autostart.cancel()
        if self.trigger_configure() is TransitionCallbackReturn.SUCCESS:
            self.trigger_activate()

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Load weights and robot; on failure say why and stay unconfigured."""
        self._health.set("warn", "loading weights and robot")
        try:
            use_threads(Threads.of(self.settings["threads"]))
            planner = Planner(planner_config(self.settings))
            get_robot(self.settings["robot"])
        except MotionDiffuseError as error:
            return self._refuse_to_configure(str(error))
        except Exception as error:
            self.get_logger().error(traceback.format_exc())
            return self._refuse_to_configure(f"{type(error).__name__}: {error}")
        publisher = PlanPublisher(self, self.settings["frame_id"], self.settings["control_rate"])
        self._configured = _Configured(
            planner,
            publisher,
            Continuity(planner, publisher.reference, self.get_clock()),
            PresentJoints(self, self.settings["joint_states"]),
        )
        self.settings.locked = True
        self._health.set("warn", "configured, not active")
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take work."""
        super().on_activate(state)
        self._queue = PlanningQueue(
            self._plan, lambda: self.settings["preempt"] or self.settings["horizon"] > 0.0
        )
        if not self._inputs:
            self._inputs = self._create_inputs()
        self._health.set("ok", "ready")
        self.get_logger().info("ready for text and goals")
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """End the work in hand; refuse new work."""
        self._stop_working("the node was deactivated")
        self._health.set("warn", "configured, not active")
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release weights, robot and interfaces."""
        self._release()
        self._health.set("warn", "unconfigured")
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """End work and release everything."""
        self._stop_working("the node was shut down")
        self._release()
        self._health.set("warn", "finalized")
        return TransitionCallbackReturn.SUCCESS

    def finish(self) -> None:
        """End the work in hand and wait until every open goal has its result."""
        self._stop_working("the node is going down")
        with self._answered:
            self._answered.wait_for(lambda: not self._outcomes, LONGEST_ANSWER)

    def _refuse_to_configure(self, reason: str) -> TransitionCallbackReturn:
        self.get_logger().error(f"not configured: {reason}")
        self._health.set("error", f"not configured: {reason}")
        return TransitionCallbackReturn.FAILURE

    def _create_inputs(self) -> list[Subscription | ActionServer]:
        return [
            self.create_subscription(
                String, "~/text", self._on_text, COMMANDS, callback_group=self._group
            ),
            self.create_subscription(
                MotionRequestMsg,
                "~/request",
                self._on_request,
                COMMANDS,
                callback_group=self._group,
            ),
            ActionServer(
                self,
                GenerateMotion,
                "~/generate_motion",
                self._execute,
                callback_group=self._group,
                handle_accepted_callback=self._on_goal,
                cancel_callback=lambda goal: CancelResponse.ACCEPT,
                goal_service_qos_profile=GOALS,
                result_service_qos_profile=GOALS,
            ),
        ]

    def _stop_working(self, reason: str) -> None:
        if self._queue is not None:
            self._queue.close(NotActive(reason))
            self._queue = None
        if self._configured is not None:
            self._configured.publisher.reference.stop()

    def _release(self) -> None:
        for entity in self._inputs:
            if isinstance(entity, Subscription):
                self.destroy_subscription(entity)
            else:
                entity.destroy()
        self._inputs = []
        if self._configured is not None:
            self._configured.publisher.destroy()
            self._configured.joints.destroy()
            self._configured = None
            return_freed_memory()  # or the next weights come on top of these
        self.settings.locked = False

    def _beat(self) -> None:
        self._feedback.repeat()
        queue = self._queue
        if queue is not None:
            queue.sweep()

    def _plan(
        self,
        request: MotionRequest,
        *,
        progress: Callable[[Progress], None],
        cancelled: Callable[[], bool],
    ) -> MotionPlan:
        """Plan and publish, piece by piece if so set; runs in the planning thread."""
        assert self._configured is not None, "deactivate ends this thread before cleanup"
        pieces = split(request, self.settings["horizon"], self.settings["first_candidates"])
        made = plan_in_pieces(
            pieces,
            partial(self._plan_piece, alone=len(pieces) == 1),
            progress=progress,
            cancelled=cancelled,
            drop=self._configured.publisher.reference.forget_what_follows,
        )
        first = made[0].message
        if len(made) == 1:
            return first
        plan = whole(request, made, track=self.settings["track"])
        self._save(plan)
        message = plan_to_message(plan, first.header, first.plan_id)
        planner, folder = self._configured.planner, self.settings["record_dir"]
        self._recorder.record(folder, planner, plan, message)
        return message

    def _plan_piece(
        self,
        request: MotionRequest,
        follows: Time | None,
        *,
        alone: bool,
        progress: Callable[[Progress], None],
        cancelled: Callable[[], bool],
    ) -> Published:
        """Plan and publish one of several pieces, or all of a request."""
        assert self._configured is not None, "deactivate ends this thread before cleanup"
        planner, continuity = self._configured.planner, self._configured.continuity
        continues = follows is not None or self.settings["continuity"]
        seam = continuity.seam(request, follows) if continues else None
        if not alone and seam is None and self.settings["few_steps"]:  # the robot stands and waits
            request = planner.hurried(request)
        plan = planner.plan(
            request,
            start=None if seam is None else seam.start,
            # the robot waits for pieces, too: what they are together is tracked
            track=self.settings["track"] and alone,
            progress=progress,
            cancelled=cancelled,
        )
        continuity.learn(plan)
        at = None
        if seam is not None:
            plan, at = continuity.fitted(plan, seam)
        present = None if at else self._configured.joints.state(get_robot(plan.robot))
        if present is not None:
            plan = planner.restarted(plan, present)
        if at is None:
            self._save(plan)
        message = self._configured.publisher.publish(plan, at)
        if at is not None:  # after publication: its time is set
            self._save(plan)
        self._recorder.record(self.settings["record_dir"], planner, plan, message)
        self.get_logger().info(
            f"planned {message.duration:.2f} s in {message.total_time:.2f} s, "
            f"{plan.report.verdict}: " + " then ".join(s.text for s in plan.request.segments)
        )
        return Published(plan, message)

    def _save(self, plan: Plan) -> None:
        """Write the plan's files, if wanted; that they cannot be written does not undo a plan."""
        folder = self.settings["plan_dir"]
        if not folder:
            return
        try:
            plan.save(Path(folder).expanduser())
        except OSError as error:
            line = f"plan_dir {folder}: not written ({error.strerror})"
            self.get_logger().error(line)

    def _submit(self, job: Job[MotionPlan]) -> Future[MotionPlan]:
        """Refuse a bad request, or queue it."""
        job.request.validate()
        queue = self._queue
        if queue is None:
            raise NotActive("the node is configured but not active; activate it first")
        queue.submit(job)
        return job.outcome

    def _on_text(self, message: String) -> None:
        self._take(
            "~/text",
            lambda: MotionRequest.from_text(
                message.data,
                default_seconds=self.settings["default_seconds"],
                robot=self.settings["robot"],
            ),
        )

    def _on_request(self, message: MotionRequestMsg) -> None:
        self._take("~/request", lambda: request_from_message(message, robot=self.settings["robot"]))

    def _take(self, source: str, read: Callable[[], MotionRequest]) -> None:
        """Queue what came on a topic; there is nobody to answer, so problems are logged."""
        try:
            outcome = self._submit(Job(complete(read(), self.settings)))
        except MotionDiffuseError as error:
            self._warn(source, error)
            return
        outcome.add_done_callback(lambda done: self._log_outcome(source, done))

    def _log_outcome(self, source: str, outcome: Future[MotionPlan]) -> None:
        error = outcome.exception()
        if isinstance(error, MotionDiffuseError):
            self._warn(source, error)
        elif error is not None:
            self._report_defect(error)
        else:
            self._health.set("ok", "ready")

    def _on_goal(self, goal: ServerGoalHandle) -> None:
        """Queue what a goal asks for, and leave the answer to a thread of its own."""
        try:
            request = request_from_message(goal.request.request, robot=self.settings["robot"])
            job = Job[MotionPlan](
                complete(request, self.settings),
                progress=lambda progress: self._feedback.tell(goal, progress),
                withdrawn=lambda: goal.is_cancel_requested,
            )
            outcome = self._submit(job)
        except Exception as error:  # told by `_answer`
            outcome = Future[MotionPlan]()
            outcome.set_exception(error)
        with self._answered:
            self._outcomes[bytes(goal.goal_id.uuid)] = outcome
        goal.execute()

    def _execute(self, goal: ServerGoalHandle) -> GenerateMotion.Result:
        """Answer one goal. Blocks a thread of the executor, not the planning."""
        key = bytes(goal.goal_id.uuid)
        try:
            return self._answer(goal, self._outcomes[key])
        finally:
            self._feedback.end(goal)
            with self._answered:
                del self._outcomes[key]
                self._answered.notify_all()

    def _answer(self, goal: ServerGoalHandle, outcome: Future[MotionPlan]) -> GenerateMotion.Result:
        result = GenerateMotion.Result()
        try:
            result.plan = outcome.result()
        except Cancelled as error:
            goal.canceled()
            result.error_code, result.message = int(error.code), str(error)
        except MotionDiffuseError as error:
            self._warn("~/generate_motion", error)
            goal.abort()
            result.error_code, result.message = int(error.code), str(error)
        except Exception as error:
            self._report_defect(error)
            goal.abort()
            result.error_code = int(ErrorCode.INTERNAL)
            result.message = f"{type(error).__name__}: {error}"
        else:
            self._health.set("ok", "ready")
            goal.succeed()
            result.message = f"{len(result.plan.trajectory.points)} points"
        return result

    def _warn(self, source: str, error: MotionDiffuseError) -> None:
        line = f"{source}: {error} [{error.code.name}]"
        self.get_logger().warning(line)
        self._health.set("warn", line)

    def _report_defect(self, error: BaseException) -> None:
        self.get_logger().error("".join(traceback.format_exception(error)))
        self._health.set("error", f"{type(error).__name__}: {error}")


def main(args: Sequence[str] | None = None) -> int:
    """Run the node; returns the exit code."""
    share_freed_memory()  # any thread may configure, and any thread clean up
    return run_node(MotionDiffuseNode, args, threads=THREADS, finish=MotionDiffuseNode.finish)


if __name__ == "__main__":
    sys.exit(main())
