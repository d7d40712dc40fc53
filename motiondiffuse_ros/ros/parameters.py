"""The parameters of the `motiondiffuse` node, and what it makes of them."""

from __future__ import annotations

from pathlib import Path

from motiondiffuse_ros.diffusion.process import SCHEDULERS
from motiondiffuse_ros.execution import EXECUTIONS
from motiondiffuse_ros.pieces import SHORTEST
from motiondiffuse_ros.planner import PlannerConfig
from motiondiffuse_ros.request import LIMITS, MotionRequest
from motiondiffuse_ros.robots import available_robots, robot_refusal
from motiondiffuse_ros.ros.parameter_spec import Parameters, ParameterSpec

_DEFAULT = PlannerConfig()

PLANNER_PARAMETERS: dict[str, ParameterSpec] = {
    "autostart": ParameterSpec(True, "configure and activate at start", at_configure=True),
    "weights": ParameterSpec("", "checkpoint folder; empty = the shipped one", at_configure=True),
    "text_encoder": ParameterSpec(
        "",
        "folder of the text encoder of a checkpoint trained with CLIP; empty = not needed",
        at_configure=True,
    ),
    "robot": ParameterSpec(
        "humanoid",
        f"robot of requests that name none: {', '.join(available_robots())}, or a description file",
        at_configure=True,
        check=robot_refusal,
    ),
    "device": ParameterSpec(_DEFAULT.device, "torch device: cpu, cuda", at_configure=True),
    "threads": ParameterSpec(
        0,
        "of the denoiser; 0 = OMP_NUM_THREADS, or one less than the cores, but two of two",
        (0, 256),
        at_configure=True,
    ),
    "scheduler": ParameterSpec(
        _DEFAULT.scheduler, "sampler of the diffusion", choices=SCHEDULERS, at_configure=True
    ),
    "part_correction": ParameterSpec(
        _DEFAULT.part_correction,
        "how far texts on different parts are drawn together [1]",
        (0.0, 1.0),
        at_configure=True,
    ),
    "time_correction": ParameterSpec(
        _DEFAULT.time_correction,
        "how far neighbours in time are drawn together [1]",
        (0.0, 1.0),
        at_configure=True,
    ),
    "apart_above": ParameterSpec(
        _DEFAULT.apart_above,
        "noise level [1] above which texts on different parts are denoised apart; 1 = never",
        (0.0, 1.0),
        at_configure=True,
    ),
    "planted_below": ParameterSpec(
        _DEFAULT.planted_below,
        "noise level [1] below which feet in contact hold the root; 0 = never",
        (0.0, 1.0),
        at_configure=True,
    ),
    "control_rate": ParameterSpec(
        _DEFAULT.control_rate,
        "of trajectories and ~/reference [Hz]",
        (1.0, 1000.0),
        at_configure=True,
    ),
    "accelerations": ParameterSpec(
        _DEFAULT.accelerations, "trajectories have accelerations too", at_configure=True
    ),
    "settle": ParameterSpec(
        _DEFAULT.settle,
        "a motion that ends in a pose that cannot be held comes to stand after it",
        at_configure=True,
    ),
    "track": ParameterSpec(
        _DEFAULT.track, "judge plans by simulated tracking too", at_configure=True
    ),
    "repair": ParameterSpec(
        _DEFAULT.repair,
        "hold feet and level the body after sampling, where that makes a motion more plausible",
        at_configure=True,
    ),
    "execution": ParameterSpec(
        _DEFAULT.execution,
        "plans are executed without assistance in simulation: not at all, to report how that "
        "ends, or to publish the executed motion; takes several times their duration",
        choices=EXECUTIONS,
        at_configure=True,
    ),
    "frame_id": ParameterSpec("map", "frame in which the root moves", at_configure=True),
    "continuity": ParameterSpec(
        True, "a plan made while another is executed goes on from that one's motion"
    ),
    "preempt": ParameterSpec(False, "a newer request also ends the planning in work"),
    "horizon": ParameterSpec(
        0.0,
        "longer motions are planned in pieces of this length, and the first is executed while the "
        f"others are sampled; newer requests then always take over; at least {SHORTEST:g}, "
        "0 = in one [s]",
        (0.0, LIMITS.max_seconds),
    ),
    "joint_states": ParameterSpec(
        "",
        "topic of the robot's joints, where plans start if none is executed; empty = not used",
        at_configure=True,
    ),
    "record_dir": ParameterSpec("", "folder in which each plan is recorded as MCAP; empty = none"),
    "plan_dir": ParameterSpec("", "folder for the files of the latest plan; empty = none"),
    "steps": ParameterSpec(
        _DEFAULT.steps, "denoising steps of requests that set none", (1, LIMITS.max_steps)
    ),
    "guidance_scale": ParameterSpec(
        _DEFAULT.guidance_scale,
        "classifier-free guidance [1] of requests that set none",
        (0.0, LIMITS.max_guidance_scale),
    ),
    "candidates": ParameterSpec(
        _DEFAULT.candidates,
        "motions sampled by requests that set no number",
        (1, LIMITS.max_candidates),
    ),
    "first_candidates": ParameterSpec(
        1,
        "most motions sampled for the first of several pieces (horizon), which a robot waits for",
        (1, LIMITS.max_candidates),
    ),
    "few_steps": ParameterSpec(
        True,
        "the first of several pieces (horizon) takes as few steps as the weights were taught to "
        "need, if it asks for whole-body texts alone",
    ),
    "survivors": ParameterSpec(
        _DEFAULT.survivors,
        "candidates that are sampled to the end, by match with the texts early on",
        (1, LIMITS.max_candidates),
        at_configure=True,
    ),
    "seed": ParameterSpec(-1, "of requests that set none; -1 = drawn", (-1, 2**63 - 1)),
    "default_seconds": ParameterSpec(
        LIMITS.default_seconds,
        "length of the motion of a sentence on ~/text [s]",
        (LIMITS.min_seconds, LIMITS.max_seconds),
    ),
}
"""All parameters of the node by name."""


def planner_config(parameters: Parameters) -> PlannerConfig:
    """Return the planner's configuration."""
    return PlannerConfig(
        weights=_path(parameters["weights"]),
        text_encoder=_path(parameters["text_encoder"]),
        scheduler=parameters["scheduler"],
        steps=parameters["steps"],
        guidance_scale=parameters["guidance_scale"],
        part_correction=parameters["part_correction"],
        time_correction=parameters["time_correction"],
        apart_above=parameters["apart_above"],
        planted_below=parameters["planted_below"],
        candidates=parameters["candidates"],
        survivors=parameters["survivors"],
        control_rate=parameters["control_rate"],
        accelerations=parameters["accelerations"],
        settle=parameters["settle"],
        device=parameters["device"],
        track=parameters["track"],
        repair=parameters["repair"],
        execution=parameters["execution"],
    )


def complete(request: MotionRequest, parameters: Parameters) -> MotionRequest:
    """Return the request with what it leaves open filled in from the parameters."""
    seed = parameters["seed"]
    return request.with_defaults(
        steps=parameters["steps"],
        guidance_scale=parameters["guidance_scale"],
        candidates=parameters["candidates"],
        seed=None if seed < 0 else seed,
    )


def _path(value: str) -> Path | None:
    return Path(value).expanduser() if value else None
