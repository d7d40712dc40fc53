"""What a user asks for: timed texts on body parts, checked before any work starts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from motiondiffuse_ros.edit import Edit
from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.fields import check_fields, names, number, rows, shown
from motiondiffuse_ros.input_file import load_yaml
from motiondiffuse_ros.motion.parts import PARTS
from motiondiffuse_ros.timeline_text import parse_timeline
from motiondiffuse_ros.waypoint import Waypoint, validate_waypoints


@dataclass(frozen=True)
class RequestLimits:
    """What a request may ask for.

    Attributes:
        min_seconds: Shortest segment and shortest motion, s.
        max_seconds: Longest motion, s.
        default_seconds: Length of a motion given by a text alone, s.
        max_text: Longest text, characters.
        max_segments: Most segments.
        max_timeline: Longest typed timeline, characters.
        max_candidates: Most candidates.
        max_steps: Most denoising steps.
        max_guidance_scale: Largest guidance scale.
        blend: Time over which neighbouring segments are blended, s; also the overlap that segments
            on the same part may have.
    """

    min_seconds: float = 0.5
    max_seconds: float = 600.0
    default_seconds: float = 6.0
    max_text: int = 300
    max_segments: int = 200
    max_timeline: int = 80_000
    max_candidates: int = 64
    max_steps: int = 1000
    max_guidance_scale: float = 20.0
    blend: float = 0.5


LIMITS = RequestLimits()
_MAX_SEED = 2**63 - 1


@dataclass(frozen=True)
class Segment:
    """A text over a span of time.

    Attributes:
        text: What to do.
        start: s from the beginning of the motion.
        end: s; after start.
        parts: Body parts that do it; empty is the whole body.
    """

    text: str
    start: float
    end: float
    parts: tuple[str, ...] = ()


@dataclass(frozen=True)
class MotionRequest:
    """A request; fields left None take the planner's defaults.

    Attributes:
        segments: At least one.
        duration: Length of the motion, s; None is the end of the last segment.
        seed: 0 to 2^63 - 1; None draws one, which the plan records.
        guidance_scale: Weight of the text against the unconditional model; 1 is none.
        steps: Denoising steps.
        candidates: Samples to choose the best from.
        robot: Name of the robot.
        waypoints: Where the root is at given times, in order of time.
        edit: An existing motion of which a part is kept.
    """

    segments: tuple[Segment, ...]
    duration: float | None = None
    seed: int | None = None
    guidance_scale: float | None = None
    steps: int | None = None
    candidates: int | None = None
    robot: str = "humanoid"
    waypoints: tuple[Waypoint, ...] = ()
    edit: Edit | None = None

    @property
    def total_seconds(self) -> float:
        """Length of the motion, s."""
        return max(s.end for s in self.segments) if self.duration is None else self.duration

    @classmethod
    def from_text(
        cls,
        text: str,
        seconds: float | None = None,
        *,
        default_seconds: float = LIMITS.default_seconds,
        **settings: Any,
    ) -> MotionRequest:
        """Ask for one text over the whole time and body, or for a typed timeline.

        Args:
            text: In plain English, or in the form of `timeline_text`.
            seconds: Length of the motion, s; None is that of the timeline or the default.
            default_seconds: Length of a text without times, s.
            **settings: Further fields.

        Raises:
            RequestError: If a timeline cannot be read.
        """
        if len(text) > LIMITS.max_timeline:
            raise RequestError(f"{len(text)} characters of text, at most {LIMITS.max_timeline}")
        pieces = parse_timeline(text)
        if pieces is not None:
            return cls(tuple(Segment(*piece) for piece in pieces), duration=seconds, **settings)
        length = default_seconds if seconds is None else seconds
        return cls((Segment(text, 0.0, length),), duration=length, **settings)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> MotionRequest:
        """Build from the fields of a request file.

        Raises:
            RequestError: If a field is unknown, missing or of the wrong type; validates too.
        """
        check_fields(cls, data, "request")
        if not isinstance(data.get("segments"), list):
            raise RequestError("request: 'segments' must be a list of {text, start, end, parts}")
        segments = [
            _segment(row, f"segment {i}") for i, row in enumerate(data["segments"], start=1)
        ]
        waypoints = rows(data.get("waypoints"), "request: 'waypoints'", "{time, x, y, heading}")
        settings = {
            k: v
            for k, v in data.items()
            if k not in ("segments", "waypoints", "edit") and v is not None
        }
        for name in ("duration", "guidance_scale"):
            if name in settings:
                settings[name] = number(settings[name], f"request: {name}")
        settings["waypoints"] = tuple(
            Waypoint.from_dict(row, f"waypoint {i}") for i, row in enumerate(waypoints, start=1)
        )
        if data.get("edit") is not None:
            settings["edit"] = Edit.from_dict(data["edit"])
        request = cls(tuple(segments), **settings)
        request.validate()
        return request

    @classmethod
    def from_yaml(cls, path: Path) -> MotionRequest:
        """Read a request file.

        Raises:
            RequestError: If it cannot be read or is not a valid request; names the file.
        """
        try:
            data = load_yaml(Path(path), RequestError)
        except OSError as error:
            raise RequestError(f"request {path}: cannot be read ({error.strerror})") from error
        try:
            return cls.from_dict(data)
        except RequestError as error:
            raise RequestError(f"{path}: {error}") from error

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types; `from_dict` takes them back."""
        data = asdict(self)
        data["segments"] = [{**s, "parts": list(s["parts"])} for s in data["segments"]]
        data["waypoints"] = list(data["waypoints"])
        if self.edit is not None:
            data["edit"] = self.edit.to_dict()
        return data

    def with_defaults(self, **defaults: Any) -> MotionRequest:
        """Fill in the fields that are None."""
        return replace(self, **{k: v for k, v in defaults.items() if getattr(self, k) is None})

    def validate(self, limits: RequestLimits = LIMITS) -> None:
        """Refuse what cannot be honoured.

        Raises:
            RequestError: One line that names the segment or field and what would be right.
        """
        if not self.segments:
            raise RequestError("request: no segments; give at least one text")
        if len(self.segments) > limits.max_segments:
            raise RequestError(
                f"request: {len(self.segments)} segments, at most {limits.max_segments}"
            )
        for i, segment in enumerate(self.segments, start=1):
            _validate_segment(segment, f"segment {i}", limits)
        _validate_range("duration", self.duration, limits.min_seconds, limits.max_seconds, " s")
        total = self.total_seconds
        for i, segment in enumerate(self.segments, start=1):
            if segment.end > total + 1e-9:
                raise RequestError(
                    f"segment {i}: ends at {segment.end:g} s, after the motion's {total:g} s"
                )
        _validate_overlaps(self.segments, limits.blend)
        _validate_whole("seed", self.seed, 0, _MAX_SEED)
        _validate_whole("steps", self.steps, 1, limits.max_steps)
        _validate_whole("candidates", self.candidates, 1, limits.max_candidates)
        _validate_range("guidance_scale", self.guidance_scale, 0.0, limits.max_guidance_scale, "")
        if not isinstance(self.robot, str) or not self.robot:
            raise RequestError(f"request: robot must be a name, got {shown(self.robot)}")
        validate_waypoints(self.waypoints, total)
        if self.edit is not None:
            self.edit.validate(total)
            if self.waypoints:
                raise RequestError("request: an edited motion keeps its path; leave out waypoints")


def _segment(row: Any, where: str) -> Segment:
    check_fields(Segment, row, where)
    if missing := {"text", "start", "end"} - set(row):
        raise RequestError(f"{where}: {', '.join(sorted(missing))} missing")
    return Segment(
        row["text"],
        number(row["start"], f"{where}: start"),
        number(row["end"], f"{where}: end"),
        names(row.get("parts"), f"{where}: 'parts'"),
    )


def _validate_segment(segment: Segment, where: str, limits: RequestLimits) -> None:
    text = segment.text
    if not isinstance(text, str) or not text.strip():
        raise RequestError(f"{where}: the text is empty; say what to do")
    if len(text) > limits.max_text:
        raise RequestError(f"{where}: {len(text)} characters of text, at most {limits.max_text}")
    if "\0" in text or any("\ud800" <= c <= "\udfff" for c in text):
        raise RequestError(f"{where}: the text {text!r} has characters that are not text")
    if not any(c.isalpha() for c in text):
        raise RequestError(f"{where}: the text {text!r} has no words")
    for name in ("start", "end"):
        value = getattr(segment, name)
        if not math.isfinite(value) or value < 0.0:
            raise RequestError(f"{where}: {name} is {value} s; times are finite and from 0")
    if segment.end > limits.max_seconds:
        raise RequestError(
            f"{where}: ends at {segment.end:g} s, the longest motion is {limits.max_seconds:g} s"
        )
    if segment.end <= segment.start:
        raise RequestError(
            f"{where}: ends at {segment.end:g} s, not after its start at {segment.start:g} s"
        )
    if segment.end - segment.start < limits.min_seconds - 1e-9:
        raise RequestError(
            f"{where}: lasts {segment.end - segment.start:g} s, at least {limits.min_seconds:g} s"
        )
    for part in segment.parts:
        if part not in PARTS:
            raise RequestError(
                f"{where}: unknown body part '{part}'; the parts are {', '.join(PARTS)}"
            )
    if len(set(segment.parts)) < len(segment.parts):
        raise RequestError(f"{where}: a body part is named twice: {', '.join(segment.parts)}")


def _validate_overlaps(segments: tuple[Segment, ...], blend: float) -> None:
    # the whole body is a track of its own, under those of the parts
    for track in (None, *PARTS):
        on_track = [
            (s.start, s.end, i)
            for i, s in enumerate(segments, start=1)
            if (track in s.parts if track else not s.parts)
        ]
        on_track.sort()
        for (_, end, a), (start, _, b) in pairwise(on_track):
            if end - start > blend + 1e-9:
                raise RequestError(
                    f"segments {a} and {b} overlap by {end - start:g} s on "
                    f"{track or 'the whole body'}; at most {blend:g} s (the blend) may overlap"
                )


def _validate_range(name: str, value: Any, low: float, high: float, unit: str) -> None:
    if value is None:
        return
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number or not low <= value <= high:
        raise RequestError(
            f"request: {name} must be from {low:g} to {high:g}{unit}, got {shown(value)}"
        )


def _validate_whole(name: str, value: Any, low: int, high: int) -> None:
    if value is None:
        return
    if not isinstance(value, int) or isinstance(value, bool) or not low <= value <= high:
        raise RequestError(
            f"request: {name} must be a whole number from {low} to {high}, got {shown(value)}"
        )
