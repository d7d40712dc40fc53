"""Places that the root has to pass, as a request gives them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from motiondiffuse_ros.errors import RequestError
from motiondiffuse_ros.fields import check_fields, number

FASTEST = 4.0
"""Greatest speed that waypoints may ask for between them [m/s]."""

LEAST_GAP = 0.2
"""Least time from the start to the first waypoint, and from each to the next [s]."""

MOST = 100
"""Most waypoints of a request."""


@dataclass(frozen=True)
class Waypoint:
    """Where the root is at one time; over where the motion starts, facing +x there (REP-103).

    Attributes:
        time: s from the start of the motion.
        x: Ahead, m.
        y: To the left, m.
        heading: About the vertical, rad; None is free.
    """

    time: float
    x: float
    y: float
    heading: float | None = None

    @classmethod
    def from_dict(cls, data: Any, where: str) -> Waypoint:
        """Build from a row of a request file.

        Raises:
            RequestError: If a field is unknown, missing or not a number.
        """
        check_fields(cls, data, where)
        if missing := {"time", "x", "y"} - set(data):
            raise RequestError(f"{where}: {', '.join(sorted(missing))} missing")
        given = {name: number(v, f"{where}: {name}") for name, v in data.items() if v is not None}
        if missing := {"time", "x", "y"} - set(given):
            raise RequestError(f"{where}: {', '.join(sorted(missing))} missing")
        return cls(**given)


def parse_waypoint(text: str) -> Waypoint:
    """Read a waypoint as people type it, `time,x,y` or `time,x,y,heading`.

    Raises:
        RequestError: If it cannot be read.
    """
    try:
        numbers = [float(piece) for piece in text.split(",")]
        return Waypoint(*numbers)
    except (ValueError, TypeError) as error:
        raise RequestError(
            f"{text!r} is not a waypoint; write TIME,X,Y or TIME,X,Y,HEADING: 3,2.0,0.5,1.57"
        ) from error


def validate_waypoints(waypoints: Sequence[Waypoint], duration: float) -> None:
    """Refuse waypoints that nobody can pass.

    Args:
        waypoints: In order of time.
        duration: Of the motion, s.

    Raises:
        RequestError: Names the waypoint and what would be right.
    """
    if len(waypoints) > MOST:
        raise RequestError(f"request: {len(waypoints)} waypoints, at most {MOST}")
    before = Waypoint(0.0, 0.0, 0.0)
    for i, waypoint in enumerate(waypoints, start=1):
        for name, unit in (("time", " s"), ("x", " m"), ("y", " m"), ("heading", " rad")):
            value = getattr(waypoint, name)
            if value is not None and not math.isfinite(value):
                raise RequestError(f"waypoint {i}: {name} is {value}{unit}; it must be finite")
        if not 0.0 < waypoint.time <= duration + 1e-9:
            raise RequestError(
                f"waypoint {i}: its time, {waypoint.time:g} s, is not within the motion, which "
                f"lasts {duration:g} s from 0"
            )
        gap = waypoint.time - before.time
        if gap < LEAST_GAP - 1e-9:
            last = "the start" if i == 1 else f"waypoint {i - 1}"
            raise RequestError(
                f"waypoint {i}: at {waypoint.time:g} s, at least {LEAST_GAP:g} s after {last} "
                f"at {before.time:g} s"
            )
        speed = math.hypot(waypoint.x - before.x, waypoint.y - before.y) / gap
        if speed > FASTEST:
            raise RequestError(
                f"waypoint {i}: needs {speed:.1f} m/s on the way there, at most {FASTEST:g} m/s"
            )
        before = waypoint
