"""The use case: from a `MotionRequest` to a `Plan`. No ROS, no command line."""

from __future__ import annotations

import json
import secrets
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

from motiondiffuse_ros.continuation import (
    Continuation,
    Start,
    continue_from,
    moved_to,
    placed,
    rejoin,
)
from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.editing import keeps_height, kept_by
from motiondiffuse_ros.errors import Cancelled, RequestError
from motiondiffuse_ros.evaluation.config import EvaluatorConfig
from motiondiffuse_ros.evaluation.evaluator import Evaluator, critic_of
from motiondiffuse_ros.execution import EXECUTIONS, NONE, PUBLISH_EXECUTED, execute
from motiondiffuse_ros.kept import Kept, constraints, path_points
from motiondiffuse_ros.manifest import folder_hashes, shipped
from motiondiffuse_ros.memory import return_freed_memory
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.bvh import write_bvh
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.repair import put_on_floor, repair_best
from motiondiffuse_ros.physics.report import Report, assess, with_tracking
from motiondiffuse_ros.request import LIMITS, MotionRequest
from motiondiffuse_ros.robots import (
    JointTrajectory,
    Robot,
    StartState,
    build_trajectory,
    get_robot,
    path_scale,
)
from motiondiffuse_ros.robots.tracking_files import save_tracking_csv, save_tracking_npz
from motiondiffuse_ros.selection import TextMatch, eligible, leading
from motiondiffuse_ros.text.sides import with_side

_T = TypeVar("_T")
_MAX_DRAWN_SEED = 2**31
_LONG = 60.0  # s; what longer motions borrow from the system is worth the time to give it back
# share of the work, for the fraction of a progress report
_STAGES = {"text": 0.02, "sampling": 0.68, "physics": 0.25, "retargeting": 0.05}


def shipped_weights() -> Path:
    """Return the folder of the weights that come with the package."""
    return shipped("base")


@dataclass(frozen=True)
class PlannerConfig:
    """How requests are planned, where they do not say so themselves.

    Attributes:
        weights: Checkpoint folder; None is the shipped one.
        text_encoder: Folder of the text encoder's files, if the checkpoint was trained with CLIP.
        scheduler: Sampler of the diffusion: ddim, ddpm or dpm-solver++.
        steps: Denoising steps; see `Planner.hurried`.
        guidance_scale: Classifier-free guidance.
        part_correction: λ₁ of eq. 10; see `SamplerConfig`.
        time_correction: λ₂ of eq. 11.
        apart_above: Noise level above which texts on different parts are denoised apart.
        planted_below: Noise level below which feet in contact hold the root.
        candidates: Motions to choose from, by match with the texts and by plausibility.
        survivors: How many of them are sampled to the end: those that will match the texts best,
            as far as can be told early (`SamplerConfig.thinned_below`).
        control_rate: Rate of the trajectory, Hz.
        accelerations: Whether trajectories have them.
        settle: Whether a trajectory whose last pose could not be held comes to stand after it.
        repair: Whether candidates are repaired where that makes them more plausible; not where
            they continue, edit or pass what was given.
        track: Whether the chosen motion is also judged by simulated tracking.
        execution: Whether it is also executed without assistance, which takes several times its
            duration: none, verify (the report says how that ended) or publish_executed (the
            plan's motion is what was executed, if that came to its end).
        device: Torch device of the denoiser.
    """

    weights: Path | None = None
    text_encoder: Path | None = None
    scheduler: str = SamplerConfig.scheduler
    steps: int = SamplerConfig.steps
    guidance_scale: float = SamplerConfig.guidance_scale
    part_correction: float = SamplerConfig.part_correction
    time_correction: float = SamplerConfig.time_correction
    apart_above: float = SamplerConfig.apart_above
    planted_below: float = SamplerConfig.planted_below
    candidates: int = 4
    survivors: int = 2
    control_rate: float = 50.0
    accelerations: bool = False
    settle: bool = True
    repair: bool = True
    track: bool = True
    execution: str = NONE
    device: str = "cpu"

    def validate(self) -> None:
        """Raise RequestError if a value is out of range."""
        self.sampler(self.steps, self.guidance_scale).validate()
        if not 1 <= self.candidates <= LIMITS.max_candidates:
            raise RequestError(
                f"candidates must be from 1 to {LIMITS.max_candidates}, got {self.candidates}"
            )
        if not 1 <= self.survivors <= LIMITS.max_candidates:
            raise RequestError(
                f"survivors must be from 1 to {LIMITS.max_candidates}, got {self.survivors}"
            )
        if not 1.0 <= self.control_rate <= 1000.0:
            raise RequestError(f"control_rate must be from 1 to 1000 Hz, got {self.control_rate}")
        if self.execution not in EXECUTIONS:
            raise RequestError(
                f"execution must be one of {', '.join(EXECUTIONS)}, got '{self.execution}'"
            )

    def sampler(self, steps: int, guidance_scale: float) -> SamplerConfig:
        """Return the sampler of a request's steps and guidance scale."""
        return SamplerConfig(
            scheduler=self.scheduler,
            steps=steps,
            guidance_scale=guidance_scale,
            part_correction=self.part_correction,
            time_correction=self.time_correction,
            apart_above=self.apart_above,
            planted_below=self.planted_below,
        )


@dataclass(frozen=True)
class Progress:
    """Where a plan stands.

    Attributes:
        stage: "text", "sampling", "physics" or "retargeting".
        fraction: Of the whole plan, 0 to 1; never falls.
        preview: What is known of the verdict so far; may be empty.
    """

    stage: str
    fraction: float
    preview: str = ""


@dataclass(frozen=True, eq=False)
class Origin:
    """What a plan was made from, besides the planner: with it the plan can be made again.

    Attributes:
        given: The request as it came, defaults not filled in.
        start: What the motion continues.
        restarts: States from which the plan was started instead, one after the other.
        pieces: What it was joined from (`joined_plan`); none if it was planned in one.
    """

    given: MotionRequest
    start: Start
    restarts: tuple[StartState, ...] = ()
    pieces: tuple[PieceOrigin, ...] = ()


@dataclass(frozen=True, eq=False)
class PieceOrigin:
    """What one of the plans that were joined was made from.

    Attributes:
        request: With all defaults filled in.
        origin: Of the plan; not joined itself.
        begins: When it takes over from the one before, from the start of that one [s].
    """

    request: MotionRequest
    origin: Origin
    begins: float


@dataclass(frozen=True, eq=False)
class Plan:
    """A motion, checked, as a trajectory for a robot.

    Attributes:
        request: With all defaults filled in.
        seed: Of all randomness; with the same weights and settings it gives the same motion.
        weights_sha256: Hash of the weights file.
        few_steps_sha256: Hash of the weights that did the first steps; empty if those did.
        robot: Name of the robot, or its description file.
        motion: The chosen candidate, its stance put on the floor.
        trajectory: For the robot's controller.
        report: Physics verdict on the motion.
        timings_s: Seconds for text, sampling, physics, retargeting and total.
        candidate: Index of the chosen candidate.
        text_match: How well it matches the texts (`selection.TextMatch`), -2 to 2; None where
            that cannot be judged or there was but one candidate.
        scheduler: Sampler that was used.
        origin: What it was made from.
    """

    request: MotionRequest
    seed: int
    weights_sha256: str
    few_steps_sha256: str
    robot: str
    motion: Motion = field(repr=False)
    trajectory: JointTrajectory = field(repr=False)
    report: Report
    timings_s: dict[str, float]
    candidate: int
    text_match: float | None
    scheduler: str
    origin: Origin = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Return the content of plan.json."""
        return {
            "request": self.request.to_dict(),
            "seed": self.seed,
            "weights_sha256": self.weights_sha256,
            "few_steps_sha256": self.few_steps_sha256,
            "robot": self.robot,
            "joint_names": list(self.trajectory.joint_names),
            "fps": self.motion.fps,
            "duration_s": self.trajectory.duration,
            "scheduler": self.scheduler,
            "candidate": self.candidate,
            "text_match": self.text_match,
            "notes": list(self.trajectory.notes),
            "report": self.report.to_dict(),
            "timings_s": self.timings_s,
        }

    def save(self, folder: Path) -> None:
        """Write the plan's files.

        plan.json, report.json, motion.bvh, motion.npz, trajectory.csv, root.csv, and for trackers
        tracking.csv and tracking.npz.
        """
        folder.mkdir(parents=True, exist_ok=True)
        write_bvh(self.motion, folder / "motion.bvh")
        self.motion.save_npz(folder / "motion.npz")
        self.trajectory.save_csv(folder / "trajectory.csv")
        self.trajectory.save_root_csv(folder / "root.csv")
        save_tracking_csv(self.trajectory, folder / "tracking.csv")
        save_tracking_npz(self.trajectory, get_robot(self.robot), folder / "tracking.npz")
        self.report.save(folder / "report.json")
        plan = json.dumps(self.to_dict(), indent=2)
        (folder / "plan.json").write_text(plan + "\n", encoding="utf-8")


class Planner:
    """Plans requests with one set of weights.

    Attributes:
        config: How.
        hashes: SHA-256 of every file of weights, text encoder and critic, as ROOM/FILE.
    """

    def __init__(self, config: PlannerConfig = PlannerConfig()) -> None:
        """Load the weights and their text encoder.

        Raises:
            RequestError: If the configuration is invalid.
            CheckpointError: If the weights cannot be used.
            TextEncoderError: If the text encoder cannot be used.
        """
        config.validate()
        self.config = config
        weights = shipped_weights() if config.weights is None else config.weights
        self._pipeline = MotionPipeline.from_pretrained(
            weights, config.text_encoder, device=config.device
        )
        self._critic = self._load_critic(weights)
        self.hashes = self._hashes(weights)

    def _load_critic(self, weights: Path) -> Evaluator | None:
        """Return the critic of the weights, if it speaks of the same features and text encoder."""
        encoder = self._pipeline.encoder
        if encoder.name != EvaluatorConfig.text_encoder:
            return None
        critic = Evaluator.from_pretrained(critic_of(weights), encoder)
        known = critic.representation == self._pipeline.representation.name
        return critic if known else None

    def _hashes(self, weights: Path) -> dict[str, str]:
        """Return the SHA-256 of every file that has a part in plans, as ROOM/FILE."""
        encoder = self._pipeline.encoder
        hashes = {f"text encoder/{encoder.name}": encoder.sha256}
        rooms = {"weights": weights}
        if self._critic is not None:
            rooms["critic"] = critic_of(weights)
        for room, folder in rooms.items():
            hashes |= {f"{room}/{name}": sha for name, sha in folder_hashes(folder).items()}
        return hashes

    @property
    def weights_sha256(self) -> str:
        """Hash of the weights file."""
        return self._pipeline.weights_sha256

    @property
    def fps(self) -> float:
        """Frame rate of the motions, Hz."""
        return self._pipeline.fps

    def hurried(self, request: MotionRequest) -> MotionRequest:
        """Return a request with as few steps as the weights were taught to need, if they were.

        Others stay as they are: of other guidance, and those that ask for more than whole-body
        texts, since few steps leave texts on parts, and what is given, few steps to become one
        with the rest.
        """
        given = request.edit is not None or request.waypoints
        if given or any(segment.parts for segment in request.segments):
            return request
        whole = self._completed(request)
        few = self._pipeline.few_steps(self._sampler(whole))
        assert whole.steps is not None
        return request if few is None or whole.steps < few else replace(request, steps=few)

    def _completed(self, request: MotionRequest) -> MotionRequest:
        """Return a request with all defaults filled in but the seed."""
        return request.with_defaults(
            duration=request.total_seconds,
            guidance_scale=self.config.guidance_scale,
            steps=self.config.steps,
            candidates=self.config.candidates,
        )

    def restarted(self, plan: Plan, state: StartState) -> Plan:
        """Return a plan that starts from another state than it was made for.

        Where the root's state is known the motion is moved there on the ground plane.
        """
        motion, robot = plan.motion, get_robot(plan.robot)
        if state.root is not None:
            heading = float(rot.twist_angle(state.root.orientation, axis=2))
            motion = moved_to(motion, state.root.position / path_scale(robot), heading)
        trajectory = build_trajectory(
            robot,
            motion,
            self.config.control_rate,
            state,
            accelerations=self.config.accelerations,
            settle=self.config.settle,
        )
        origin = replace(plan.origin, restarts=(*plan.origin.restarts, state))
        return replace(plan, motion=motion, trajectory=trajectory, origin=origin)

    def plan(
        self,
        request: MotionRequest,
        *,
        start: Start | None = None,
        track: bool | None = None,
        progress: Callable[[Progress], None] | None = None,
        cancelled: Callable[[], bool] | None = None,
    ) -> Plan:
        """Sample, choose, check and retarget.

        Args:
            request: What to do.
            start: What the motion continues, and the state in which the robot will be; None
                starts over the origin with the motion's first pose.
            track: Whether the chosen motion is also judged by simulated tracking; None is as
                configured.
            progress: Told of every stage and denoising step.
            cancelled: Asked before every denoising step and between stages.

        Raises:
            RequestError: If the request is invalid; before any work.
            RobotError: If the robot is unknown; before any work.
            MotionFileError: If the motion to edit cannot be read; before any work.
            Cancelled: If `cancelled` said so.
        """
        request.validate()
        robot = get_robot(request.robot)
        track = self.config.track if track is None else track
        watch = _Stages(progress, cancelled)
        plan = self._planned(request, robot, start or Start(), track, watch)
        if request.total_seconds > _LONG:  # here, where nothing but the plan is left of the work
            return_freed_memory()
        return plan

    def _planned(
        self, request: MotionRequest, robot: Robot, start: Start, track: bool, watch: _Stages
    ) -> Plan:
        config, origin = self.config, Origin(request, start)
        request = self._completed(request).with_defaults(seed=secrets.randbelow(_MAX_DRAWN_SEED))
        texts, frames = timeline(request, self._pipeline.fps)
        critic = None if request.candidates == 1 else self._critic  # there is nothing to choose
        match = None if critic is None else TextMatch(critic, texts)
        candidates = self._sample(request, start, texts, frames, match, watch)
        given = start.lead_in is not None or request.edit is not None or request.waypoints
        repairs = config.repair and not given
        best = self._choose(candidates, match, request, robot, watch, repairs, track)
        trajectory = watch.run(
            "retargeting",
            lambda: build_trajectory(
                robot,
                best.motion,
                config.control_rate,
                start.state,
                accelerations=config.accelerations,
                settle=config.settle,
                progress=lambda share: watch.advance("retargeting", share),
                cancelled=watch.cancelled,
            ),
        )
        assert request.seed is not None
        return Plan(
            request=request,
            seed=request.seed,
            weights_sha256=self.weights_sha256,
            few_steps_sha256=self._pipeline.few_steps_sha256(self._sampler(request)),
            robot=robot.name,
            motion=best.motion,
            trajectory=trajectory,
            report=best.report,
            timings_s=watch.timings(),
            candidate=best.candidate,
            text_match=best.text_match,
            scheduler=config.scheduler,
            origin=origin,
        )

    def _sampler(self, request: MotionRequest) -> SamplerConfig:
        """Return the sampler of a completed request."""
        assert request.guidance_scale is not None
        assert request.steps is not None
        return self.config.sampler(request.steps, request.guidance_scale)

    def _sample(
        self,
        request: MotionRequest,
        start: Start,
        texts: tuple[TimedText, ...],
        frames: int,
        match: TextMatch | None,
        watch: _Stages,
    ) -> dict[int, Motion]:
        """Return the motions of the candidates that were sampled to the end."""
        assert request.candidates is not None
        assert request.seed is not None
        pipeline = self._pipeline
        lead_in, edited = self._given(request, start, frames)
        before = lead_in.frames if lead_in else 0
        kept = lead_in.kept if lead_in else edited
        points = path_points(
            request.waypoints,
            request.total_seconds,
            pipeline.fps,
            lead_in.seam if lead_in else None,
        )
        keep_to = constraints(pipeline, kept, points, before + frames)

        def best(candidates: Sequence[Array]) -> list[int]:
            assert match is not None
            return leading(match([x[before:] for x in candidates]), self.config.survivors)

        watch.enter("text")
        samples = pipeline(
            tuple(_later(text, before) for text in texts),
            before + frames,
            config=self._sampler(request),
            candidates=request.candidates,
            seed=request.seed,
            blend_frames=round(LIMITS.blend * pipeline.fps),
            constraints=keep_to,
            choose=None if match is None or request.candidates <= self.config.survivors else best,
            on_step=lambda done, total: watch.advance("sampling", done / total),
            cancelled=watch.cancelled,
        )
        watch.record("text", samples.text_seconds)
        watch.record("sampling", samples.sampling_seconds)
        finished = (self._finished(m, start, before, edited) for m in samples.motions)
        return dict(zip(samples.candidates, finished, strict=True))

    def _given(
        self, request: MotionRequest, start: Start, frames: int
    ) -> tuple[Continuation | None, Kept | None]:
        """Return the lead-in or what is kept of an edited motion; at most one of them."""
        representation, fps = self._pipeline.representation, self._pipeline.fps
        if request.edit is not None:
            return None, kept_by(request.edit, frames, fps, representation)
        if start.lead_in is None:
            return None, None
        return continue_from(start.lead_in, frames, fps, representation.dim), None

    def _finished(self, motion: Motion, start: Start, before: int, edited: Kept | None) -> Motion:
        """Put a sampled motion on the floor, and where it is to start."""
        if before and start.lead_in is not None:
            return rejoin(motion, start.lead_in, before)
        if edited is None or not keeps_height(edited, self._pipeline.representation):
            motion = put_on_floor(motion)
        if start.lead_in is None:
            return motion
        return placed(motion, start.lead_in.slice(start.lead_in.frames - 1, start.lead_in.frames))

    def _choose(
        self,
        candidates: dict[int, Motion],
        match: TextMatch | None,
        request: MotionRequest,
        robot: Robot,
        watch: _Stages,
        repairs: bool,
        track: bool,
    ) -> _Chosen:

        def assessed(motion: Motion) -> Report:
            return assess(
                motion,
                segments=request.segments,
                robot=robot if robot.is_canonical else None,
                track=False,
                cancelled=watch.cancelled,
            )

        def judge() -> _Chosen:
            matches = dict(zip(candidates, self._matches(match, candidates.values()), strict=True))
            able = {i: candidates[i] for i in eligible(matches)}
            reports: list[Report] = []

            def judged(motion: Motion) -> Report:
                reports.append(assessed(motion))
                share = min(len(reports) / (2 * len(able)), 1.0)
                watch.advance("physics", 0.6 * share, reports[-1].verdict)
                return reports[-1]

            if repairs:
                best, repaired = repair_best(able, judged)
                motion, report = repaired.motion, repaired.report
            else:
                scored = {i: judged(candidate) for i, candidate in able.items()}
                best = max(scored, key=lambda i: scored[i].score)
                motion, report = able[best], scored[best]
            if self.config.execution != NONE:
                motion, report = execute(
                    motion,
                    report,
                    publish=self.config.execution == PUBLISH_EXECUTED,
                    judge=assessed,
                    cancelled=watch.cancelled,
                    progress=lambda share: watch.advance("physics", 0.6 + 0.3 * share),
                )
            if track:
                report = with_tracking(report, motion, cancelled=watch.cancelled)
            watch.advance("physics", 1.0, report.verdict)
            return _Chosen(best, matches[best], motion, report)

        return watch.run("physics", judge)

    def _matches(self, match: TextMatch | None, motions: Collection[Motion]) -> list[float | None]:
        if match is None:
            return [None] * len(motions)
        return match([self._pipeline.representation.encode(motion) for motion in motions])


def timeline(request: MotionRequest, fps: float) -> tuple[tuple[TimedText, ...], int]:
    """Return a request's texts in frames, and the number of frames (both ends included).

    Texts are as the denoiser is told them: with a side where they leave it open (`with_side`).
    """
    frames = round(request.total_seconds * fps) + 1
    texts = []
    for segment in request.segments:
        start, stop = round(segment.start * fps), round(segment.end * fps)
        # the frame at the very end belongs to whoever ends there
        texts.append(
            TimedText(
                with_side(segment.text.strip()),
                start,
                frames if stop >= frames - 1 else stop,
                segment.parts,
            )
        )
    return tuple(texts), frames


def _later(text: TimedText, frames: int) -> TimedText:
    """Return a text moved on; one at the start also covers what is put before it."""
    start = text.start + frames if text.start > 0 else 0
    return replace(text, start=start, stop=text.stop + frames)


@dataclass(frozen=True, eq=False)
class _Chosen:
    """The candidate that was chosen, how well it matches the texts, its motion and full report."""

    candidate: int
    text_match: float | None
    motion: Motion
    report: Report


class _Stages:
    """Progress, cancellation and timings of one plan."""

    def __init__(
        self,
        progress: Callable[[Progress], None] | None,
        cancelled: Callable[[], bool] | None,
    ) -> None:
        self._progress, self._cancelled = progress, cancelled
        self._began = time.perf_counter()
        self._seconds = dict.fromkeys(_STAGES, 0.0)

    def cancelled(self) -> bool:
        return self._cancelled is not None and self._cancelled()

    def enter(self, stage: str) -> None:
        if self.cancelled():
            raise Cancelled(f"canceled before {stage}")
        self.advance(stage, 0.0)

    def advance(self, stage: str, fraction: float, preview: str = "") -> None:
        if self._progress is not None:
            before = 0.0
            for name, share in _STAGES.items():
                if name == stage:
                    break
                before += share
            self._progress(Progress(stage, before + fraction * _STAGES[stage], preview))

    def run(self, stage: str, work: Callable[[], _T]) -> _T:
        self.enter(stage)
        began = time.perf_counter()
        result = work()
        self.record(stage, time.perf_counter() - began)
        self.advance(stage, 1.0)
        return result

    def record(self, stage: str, seconds: float) -> None:
        self._seconds[stage] = seconds

    def timings(self) -> dict[str, float]:
        rounded = {stage: round(seconds, 4) for stage, seconds in self._seconds.items()}
        return {**rounded, "total": round(time.perf_counter() - self._began, 4)}
