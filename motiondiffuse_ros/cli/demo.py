"""`motiondiffuse demo`: words to a simulated robot's motion, over a real ROS 2 graph."""

from __future__ import annotations

import os
from contextlib import ExitStack
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from motiondiffuse_ros.action import GenerateMotion
from motiondiffuse_ros.errors import ErrorCode, MotionDiffuseError, RequestError
from motiondiffuse_ros.render.executed_motion import render_executed_motion
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots.simulation import ExecutedMotion
from motiondiffuse_ros.ros.client import Feedback, MotionClient, Unreachable
from motiondiffuse_ros.ros.conversions import request_to_message
from motiondiffuse_ros.ros.execution_status import stamp_key
from motiondiffuse_ros.ros.processes import isolate, ros_arguments, running

START_TIMEOUT = 180.0
"""For loading torch, weights and robot on a slow machine [s]."""

WORK_TIMEOUT = 600.0
"""For planning, and again for following [s]."""


def run_demo(
    text: str = "a person walks forward and waves with the right hand",
    *,
    seconds: float = 6.0,
    seed: int = 7,
    weights: Path | None = None,
    robot: str = "humanoid",
    out: Path = Path("out"),
) -> int:
    """Plan a motion from text and let a simulated robot do it, as separate ROS 2 processes.

    Starts the nodes `motiondiffuse` and `sim`, sends the text as an action goal, waits until the
    robot has followed the trajectory, and leaves in the folder: plan.json, report.json,
    trajectory.csv, root.csv, motion.bvh, motion.npz, executed.npz, demo.gif (or demo.mp4), and
    what the nodes printed in log/. Uses ROS_DOMAIN_ID if it is set, so that other tools can
    watch, and a domain of its own otherwise.

    Args:
        text: What to do, in plain English.
        seconds: Length of the motion [s].
        seed: Of the noise.
        weights: Checkpoint folder; the shipped one if not given.
        robot: Robot to plan for and to simulate.
        out: Folder for the results.

    Returns:
        Exit code: 0, 2 if the request was refused, 1 if anything else failed.
    """
    console = Console()
    try:
        request = MotionRequest.from_text(text, seconds=seconds, seed=seed, robot=robot)
        request.validate()
    except RequestError as error:
        console.print(f"[red]{error}[/red]")
        return 2
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    executed = out / "executed.npz"
    executed.unlink(missing_ok=True)
    os.environ.setdefault("ROS_LOG_DIR", str(out / "log"))
    isolate(os.environ, os.getpid())
    try:
        _plan_and_follow(request, weights, out, executed, console)
        picture = render_executed_motion(ExecutedMotion.load_npz(executed), out / "demo")
    except _GoalFailed as failure:
        console.print(f"[red]{failure}[/red]")
        return failure.exit_code
    except (Unreachable, MotionDiffuseError) as error:
        console.print(f"[red]{error}[/red]; see {out / 'log'}")
        return 1
    console.print(f"{picture} shows what the robot did; everything is in {out}")
    return 0


class _GoalFailed(Exception):
    """The node answered the goal with an error."""

    def __init__(self, result: GenerateMotion.Result) -> None:
        code = ErrorCode(result.error_code)
        super().__init__(f"{result.message} [{code.name}]")
        self.exit_code = 2 if code < ErrorCode.SAMPLING_FAILED else 1


def _plan_and_follow(
    request: MotionRequest, weights: Path | None, out: Path, executed: Path, console: Console
) -> None:
    log = out / "log"
    with ExitStack() as stack:
        node = stack.enter_context(
            running(
                "motiondiffuse_ros.ros.node",
                ros_arguments(
                    weights=weights.resolve() if weights else "", robot=request.robot, plan_dir=out
                ),
                log / "node.log",
            )
        )
        sim = stack.enter_context(
            running(
                "motiondiffuse_ros.ros.sim_node",
                ros_arguments(robot=request.robot, record=executed),
                log / "sim.log",
            )
        )
        client = stack.enter_context(
            MotionClient(lambda: node.poll() is None and sim.poll() is None)
        )
        bar = stack.enter_context(_progress_bar(console))
        step = bar.add_task("starting the nodes", total=None)
        client.wait_for_node(START_TIMEOUT)

        def on_feedback(feedback: Feedback) -> None:
            bar.update(step, description=feedback.stage, completed=feedback.fraction, total=1.0)

        result = client.generate(request_to_message(request), on_feedback, WORK_TIMEOUT)
        if result.error_code != GenerateMotion.Result.SUCCESS:
            raise _GoalFailed(result)
        _print_plan(console, result)
        bar.update(step, description="the robot follows", total=None)
        values = client.wait_for_execution(
            stamp_key(result.plan.header.stamp),
            lambda status: bar.update(step, description=f"the robot is {status.message}"),
            WORK_TIMEOUT,
        )
        bar.update(step, description="done", total=1.0, completed=1.0)
    _print_execution(console, values)


def _progress_bar(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description:<24}"), BarColumn(), TimeElapsedColumn(), console=console
    )


def _print_plan(console: Console, result: GenerateMotion.Result) -> None:
    plan = result.plan
    verdicts = {
        plan.report.PLAUSIBLE: "plausible",
        plan.report.MARGINAL: "marginal",
        plan.report.IMPLAUSIBLE: "implausible",
    }
    console.print(
        f"{plan.duration:.2f} s of {len(plan.trajectory.joint_names)} joints planned in "
        f"{plan.total_time:.2f} s (sampling {plan.sampling_time:.2f} s): "
        f"{verdicts[plan.report.verdict]}, score {plan.report.score:.2f}"
    )
    for reason in plan.report.reasons:
        console.print(f"  {reason}")


def _print_execution(console: Console, values: dict[str, str]) -> None:
    console.print(
        f"followed in simulation, root {values['root']} "
        f"({values['assistance_body_weights']} body weights on average): joint error "
        f"{values['joint_error_rad']} rad rms, root {values['root_error_m']} m"
    )
