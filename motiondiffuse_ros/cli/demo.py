"""`motiondiffuse demo`: words to a simulated robot's motion, over a real ROS 2 graph."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from motiondiffuse_ros.action import GenerateMotion
from motiondiffuse_ros.cli.parsing import parse
from motiondiffuse_ros.errors import ErrorCode
from motiondiffuse_ros.render.executed_motion import render_executed_motion
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import get_robot
from motiondiffuse_ros.robots.simulation import ExecutedMotion
from motiondiffuse_ros.ros.client import Feedback, MotionClient, NotConfigured, Unreachable
from motiondiffuse_ros.ros.conversions import request_to_message
from motiondiffuse_ros.ros.conversions.report import VERDICTS
from motiondiffuse_ros.ros.execution_status import stamp_key
from motiondiffuse_ros.ros.processes import isolate, ros_arguments, running

START_TIMEOUT = 180.0
"""For loading torch, weights and robot on a slow machine [s]."""

WORK_TIMEOUT = 600.0
"""For planning, and again for following [s]."""


@dataclass(frozen=True)
class Demo:
    """Plan a motion from text and let a simulated robot do it, as separate ROS 2 processes.

    Starts the nodes `motiondiffuse` and `sim`, sends the text as an action goal, waits until the
    robot has followed the trajectory, and leaves in the output folder: plan.json, report.json,
    trajectory.csv, root.csv, motion.bvh, motion.npz, executed.npz, demo.gif (demo.mp4 where
    imageio-ffmpeg is installed) and what the nodes printed in log/. Uses ROS_DOMAIN_ID if it is
    set, so that other tools can watch, and a domain of its own otherwise.
    """

    text: Annotated[str, tyro.conf.Positional] = "a person walks forward and waves"
    """What to do, in plain English."""
    seconds: float = 6.0
    """Length of the motion [s]."""
    seed: int = 7
    """Of all randomness."""
    steps: int | None = None
    """Denoising steps."""
    candidates: int | None = None
    """Motions to choose the most plausible from."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    robot: str = "humanoid"
    """Robot to plan for and to simulate."""
    out: Path = Path("out")
    """Folder for the results."""


def main(arguments: Sequence[str]) -> int:
    """Run the command; returns the exit code."""
    options = parse(Demo, arguments, "demo")
    request = MotionRequest.from_text(
        options.text,
        options.seconds,
        seed=options.seed,
        steps=options.steps,
        candidates=options.candidates,
        robot=options.robot,
    )
    request.validate()
    get_robot(request.robot)
    out = options.out.resolve()
    executed = out / "executed.npz"
    executed.unlink(missing_ok=True)
    os.environ.setdefault("ROS_LOG_DIR", str(out / "log" / "ros"))
    isolate(os.environ, os.getpid())
    console = Console()
    try:
        _plan_and_follow(request, options.weights, executed, console)
    except _GoalFailed as failure:
        print(f"motiondiffuse: {failure}", file=sys.stderr)
        return failure.exit_code
    except NotConfigured as error:
        print(f"motiondiffuse: {error}", file=sys.stderr)
        return 2
    except Unreachable as error:
        print(f"motiondiffuse: {error}; see {out / 'log'}", file=sys.stderr)
        return 1
    picture = render_executed_motion(ExecutedMotion.load_npz(executed), out / "demo")
    console.print(f"{picture.name} shows what the robot did; all is in {out}", highlight=False)
    return 0


class _GoalFailed(Exception):
    """The node answered the goal with an error."""

    def __init__(self, result: GenerateMotion.Result) -> None:
        code = ErrorCode(result.error_code)
        super().__init__(f"{result.message} [{code.name}]")
        self.exit_code = 2 if code < ErrorCode.SAMPLING_FAILED else 1


def _plan_and_follow(
    request: MotionRequest, weights: Path | None, executed: Path, console: Console
) -> None:
    out = executed.parent
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
    verdicts = {code: name for name, code in VERDICTS.items()}
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
