"""`Record`: what a recording holds for planning the same again."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from motiondiffuse_ros.diffusion.threads import Threads, threads
from motiondiffuse_ros.errors import RecordingError
from motiondiffuse_ros.fields import check_fields
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.planner import Origin, PieceOrigin, Plan, Planner, PlannerConfig
from motiondiffuse_ros.recording import arrays
from motiondiffuse_ros.recording.robot_hashes import robot_hashes
from motiondiffuse_ros.recording.surroundings import surroundings
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import get_robot

FORMAT = 2
_PATHS = ("weights", "text_encoder")


@dataclass(frozen=True, eq=False)
class RecordedPiece:
    """One of the plans that a recorded one was joined from; as in `Record`.

    Attributes:
        given: The request as it came to the planner.
        request: With all defaults filled in and the seed drawn.
        restarts: How many states it was started from instead.
        begins: When it takes over from the one before, from the start of that one [s].
    """

    given: MotionRequest
    request: MotionRequest
    restarts: int
    begins: float

    def to_dict(self) -> dict[str, Any]:
        """Return JSON types; `from_dict` takes them back."""
        return {
            "given": self.given.to_dict(),
            "request": self.request.to_dict(),
            "restarts": self.restarts,
            "begins": self.begins,
        }

    @classmethod
    def from_dict(cls, data: Any) -> RecordedPiece:
        """Build from what `to_dict` returned; KeyError or TypeError where something is missing."""
        return cls(
            given=MotionRequest.from_dict(data["given"]),
            request=MotionRequest.from_dict(data["request"]),
            restarts=int(data["restarts"]),
            begins=float(data["begins"]),
        )


@dataclass(frozen=True, eq=False)
class Record:
    """A plan and what it was made from.

    Attributes:
        settings: Of the planner.
        given: The request as it came to the planner.
        request: With all defaults filled in and the seed drawn.
        restarts: How many states the plan was started from instead, one after the other.
        hashes: SHA-256 of weights, text encoder, robot, and critic if it had a part in the choice.
        surroundings: Code, libraries and machine.
        threads: How work was shared between processor cores.
        candidate: Index of the chosen one.
        joint_names: Of the trajectory.
        plan: Content of plan.json: report, notes, timings.
        values: Start, restarts and trajectory as arrays; start and restarts of each piece too.
        edited: Content of the motion file that was edited; empty if none was.
        pieces: What it was joined from; none if it was planned in one.
    """

    settings: PlannerConfig
    given: MotionRequest
    request: MotionRequest
    restarts: int
    hashes: dict[str, str]
    surroundings: dict[str, str]
    threads: Threads
    candidate: int
    joint_names: tuple[str, ...] = field(repr=False)
    plan: dict[str, Any] = field(repr=False)
    values: dict[str, Array] = field(repr=False)
    edited: bytes = field(default=b"", repr=False)
    pieces: tuple[RecordedPiece, ...] = field(default=(), repr=False)

    @property
    def trajectory(self) -> dict[str, Array]:
        """Arrays of the trajectory by name."""
        return arrays.within("trajectory", self.values)

    @property
    def origin(self) -> Origin:
        """What the plan was made from.

        Raises:
            RecordingError: If arrays are missing or of a wrong shape.
        """
        try:
            origin = _origin(self.given, self.restarts, self.values)
            pieces = tuple(
                PieceOrigin(
                    piece.request,
                    _origin(piece.given, piece.restarts, arrays.within(f"piece/{i}", self.values)),
                    piece.begins,
                )
                for i, piece in enumerate(self.pieces)
            )
            return replace(origin, pieces=pieces)
        except (KeyError, IndexError, ValueError) as error:
            raise RecordingError(f"the recorded start cannot be read ({error})") from error

    def to_dict(self) -> dict[str, Any]:
        """Return everything but arrays and files as JSON types; `from_dict` takes it back."""
        settings = asdict(self.settings)
        settings |= {name: settings[name] and str(settings[name]) for name in _PATHS}
        return {
            "format": FORMAT,
            "settings": settings,
            "given": self.given.to_dict(),
            "request": self.request.to_dict(),
            "restarts": self.restarts,
            "hashes": self.hashes,
            "surroundings": self.surroundings,
            "threads": self.threads.of_products,
            "halves": self.threads.halves,
            "candidate": self.candidate,
            "joint_names": list(self.joint_names),
            "plan": self.plan,
            "pieces": [piece.to_dict() for piece in self.pieces],
        }

    @classmethod
    def from_dict(cls, data: Any, values: dict[str, Array], edited: bytes) -> Record:
        """Build from what `to_dict` returned.

        Raises:
            RecordingError: If it is of another format, or fields are missing or wrong.
            RequestError: If the request or a setting is not valid in this version.
        """
        version = data.get("format") if isinstance(data, dict) else None
        if version != FORMAT:
            raise RecordingError(f"of format {version!r}, this version reads {FORMAT}")
        try:
            settings = data["settings"]
            check_fields(PlannerConfig, settings, "settings of the planner")
            paths = {name: Path(settings[name]) for name in _PATHS if settings[name]}
            return cls(
                settings=PlannerConfig(**{**settings, **paths}),
                given=MotionRequest.from_dict(data["given"]),
                request=MotionRequest.from_dict(data["request"]),
                restarts=int(data["restarts"]),
                hashes=_texts(data["hashes"]),
                surroundings=_texts(data["surroundings"]),
                threads=Threads(int(data["threads"]), bool(data.get("halves", False))),
                candidate=int(data["candidate"]),
                joint_names=tuple(map(str, data["joint_names"])),
                plan=dict(data["plan"]),
                values=values,
                edited=edited,
                pieces=tuple(map(RecordedPiece.from_dict, data["pieces"])),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise RecordingError(f"a field is missing or wrong ({error})") from error


def record_of(planner: Planner, plan: Plan) -> Record:
    """Return the record of a plan that a planner of this process has just made.

    Raises:
        OSError: If the motion file that was edited is gone.
    """
    values = arrays.under("trajectory", arrays.of_trajectory(plan.trajectory))
    values |= _of_origin(plan.origin)
    for i, piece in enumerate(plan.origin.pieces):
        values |= arrays.under(f"piece/{i}", _of_origin(piece.origin))
    edit = plan.request.edit
    return Record(
        settings=_absolute(planner.config),
        given=plan.origin.given,
        request=plan.request,
        restarts=len(plan.origin.restarts),
        hashes={**hashes_of(planner, plan), **robot_hashes(get_robot(plan.robot))},
        surroundings=surroundings(),
        threads=threads(),
        candidate=plan.candidate,
        joint_names=plan.trajectory.joint_names,
        plan=plan.to_dict(),
        values=values,
        edited=b"" if edit is None else Path(edit.motion).read_bytes(),
        pieces=tuple(
            RecordedPiece(
                piece.origin.given, piece.request, len(piece.origin.restarts), piece.begins
            )
            for piece in plan.origin.pieces
        ),
    )


def hashes_of(planner: Planner, plan: Plan) -> dict[str, str]:
    """Return the planner's hashes; the critic's only if it had a part in the choice."""
    judged = plan.text_match is not None
    return {k: v for k, v in planner.hashes.items() if judged or not k.startswith("critic/")}


def _of_origin(origin: Origin) -> dict[str, Array]:
    """Return start and restarts as arrays."""
    values = arrays.under("start", arrays.of_start(origin.start))
    for i, state in enumerate(origin.restarts):
        values |= arrays.under(f"restart/{i}", arrays.of_state(state))
    return values


def _origin(given: MotionRequest, restarts: int, values: arrays.Arrays) -> Origin:
    """Return what `_of_origin` took apart; KeyError, IndexError or ValueError where it is not."""
    states = (arrays.within(f"restart/{i}", values) for i in range(restarts))
    start = arrays.to_start(arrays.within("start", values))
    return Origin(given, start, tuple(map(arrays.to_state, states)))


def _absolute(config: PlannerConfig) -> PlannerConfig:
    given = {name: getattr(config, name) for name in _PATHS}
    paths = {name: path.expanduser().resolve() for name, path in given.items() if path is not None}
    return replace(config, **paths)


def _texts(data: Any) -> dict[str, str]:
    return {str(key): str(value) for key, value in dict(data).items()}
