"""Random and mutated input through reading, validation and conversion.

Whatever comes in, what comes out is either a request that survives conversion both ways or a
`MotionDiffuseError` with a code and one line. Prints how often each code came; exit code 1 and the
seed of each case if anything else happened.

    python -m benchmarks.fuzz --cases 100000
"""

from __future__ import annotations

import argparse
import copy
import json
import math
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from std_msgs.msg import Header

from motiondiffuse_ros.edit import parse_spans
from motiondiffuse_ros.errors import LONGEST_MESSAGE, ErrorCode, MotionDiffuseError, RobotError
from motiondiffuse_ros.motion import PARTS
from motiondiffuse_ros.msg import MotionEdit, MotionSegment
from motiondiffuse_ros.msg import MotionRequest as MotionRequestMsg
from motiondiffuse_ros.msg import Waypoint as WaypointMsg
from motiondiffuse_ros.planner import timeline
from motiondiffuse_ros.request import MotionRequest
from motiondiffuse_ros.robots import JointTrajectory, robot_refusal
from motiondiffuse_ros.robots.simulation.reference_path import ReferencePath
from motiondiffuse_ros.ros.conversions import (
    joint_trajectory_to_message,
    request_from_message,
    request_to_message,
    root_trajectory_to_message,
    trajectory_from_messages,
)
from motiondiffuse_ros.waypoint import parse_waypoint

Random = np.random.Generator
FPS = 20.0

NUMBERS = (
    *(0.0, -0.0, 0.5, 1.0, 2.0, 4.0, 6.0, 0.1, -1.0, 1e-300, 1e-9, 1e9, 1e300, -1e300),
    *(math.nan, math.inf, -math.inf, 599.999, 600.0, 600.1, 2.0**31, 2.0**63),
)
WHOLE = (0, 1, -1, 2, 64, 65, 1000, 1001, 2**31, 2**32 - 1, 2**63 - 1, -(2**63))
TEXTS = (
    *("a person walks", "", " ", "\t\n", "...", "123", "\0", "walk\0", "\ud800 walk", "走る", "🚶"),
    *("a" * 300, "a" * 301, "a" * 5000, "[0-4] a person walks", "[", "]", "[1", "%s{0}$(ls)`ls`"),
    *("\u202ewalk", "walk\r\nfast", "\x1b[31mwalk", "walk" + "\u0301" * 290, "'; drop", "..\\x00"),
)
NAMES = (
    *(*PARTS, "tail", "", "LEGS", "left_arm ", "a" * 3000, "\ud800", "humanoid", "g1", "robby"),
    *("/dev/null", "/dev/zero", "/", "~nobody/x.yaml", "x.yaml", "a" * 5000 + ".yaml", "\0.yaml"),
    *("../../etc/passwd", "a/" * 3000 + "b.npz", "x.npz", "x.bvh", "\n.yml"),
)
ODD: tuple[Any, ...] = (
    *(None, True, False, [], {}, [[]], {"a": 1}, "1", b"1", 10**400, -(10**400), 1 << 20000),
    *([None], ["a", 1], [[1, 2, 3]], (), 1j, object, {1: 2}, {None: None}, float("nan")),
)
SCRAPS = (
    "[",
    "]",
    "|",
    "-",
    "–",
    ":",
    "+",
    ",",
    "0",
    "9",
    ".",
    "s",
    " ",
    "\n",
    "walk",
    "head",
    "٣",
)


def _pick(random: Random, values: tuple[Any, ...]) -> Any:
    return values[int(random.integers(len(values)))]


def _valid(random: Random) -> dict[str, Any]:
    """Return the fields of a request file that is as it should be."""
    seconds = float(random.integers(2, 20))
    cut = round(float(random.uniform(0.5, seconds - 0.5)), 2)
    segments: list[dict[str, Any]] = [
        {"text": "a person walks", "start": 0.0, "end": cut},
        {"text": "turns left", "start": cut, "end": seconds},
    ]
    if random.random() < 0.5:
        parts = [str(p) for p in random.permutation(list(PARTS))[: random.integers(1, 4)]]
        segments.append({"text": "waves", "start": 0.0, "end": seconds, "parts": parts})
    data: dict[str, Any] = {"segments": segments, "duration": seconds, "seed": 7, "robot": "g1"}
    data |= {"guidance_scale": 2.5, "steps": 10, "candidates": 2}
    if random.random() < 0.4:
        data["waypoints"] = [
            {"time": t, "x": 0.5 * t, "y": 0.1, "heading": None if t > 1.0 else 0.3}
            for t in np.linspace(0.5, seconds, 3).tolist()
        ]
    elif random.random() < 0.5:
        data["edit"] = {"motion": "x.npz", "regenerate": ["head"], "keep": [[0.0, 0.5]]}
    return data


def _places(node: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the path of everything in a tree of mappings and lists."""
    items: Any = ()
    if isinstance(node, dict):
        items = node.items()
    elif isinstance(node, list):
        items = enumerate(node)
    return [path, *(place for key, child in items for place in _places(child, (*path, key)))]


def _anything(random: Random) -> Any:
    return copy.copy(_pick(random, _pick(random, (NUMBERS, WHOLE, TEXTS, NAMES, ODD))))


def _mutate(random: Random, tree: Any) -> Any:
    """Change a tree in one place."""
    places = _places(tree)
    path = places[int(random.integers(len(places)))]
    if not path:
        return _anything(random) if random.random() < 0.1 else tree
    parent = tree
    for key in path[:-1]:
        parent = parent[key]
    way, value = random.random(), parent[path[-1]]
    if way < 0.55 and isinstance(value, (int, float)):
        parent[path[-1]] = _pick(random, NUMBERS if random.random() < 0.7 else WHOLE)
    elif way < 0.55 and isinstance(value, str):
        parent[path[-1]] = _pick(random, TEXTS if random.random() < 0.5 else NAMES)
    elif way < 0.7:
        parent[path[-1]] = _anything(random)
    elif way < 0.8:
        del parent[path[-1]]
    elif way < 0.9 and isinstance(value, list):
        parent[path[-1]] = value * int(_pick(random, (2, 3, 150, 300)))
    elif isinstance(parent, dict):
        parent[_pick(random, (*NAMES, 3, None, 1 << 20000))] = _anything(random)
    return tree


def _tree(random: Random) -> Any:
    tree = _valid(random)
    for _ in range(int(random.choice([0, 1, 1, 2, 3, 8]))):
        tree = _mutate(random, tree)
    return tree


def _check(request: MotionRequest) -> None:
    """What the node does with a request before it plans."""
    request.validate()
    if refusal := robot_refusal(request.robot):
        raise RobotError(refusal)
    texts, frames = timeline(request, FPS)
    assert frames > 1
    assert all(0 <= text.start < text.stop <= frames for text in texts)
    message = request_to_message(request)
    # 0 is the message's word for "not set"
    given = request if request.guidance_scale else request.with_defaults(guidance_scale=None)
    back = request_from_message(message, robot="")
    assert back == given or not request.guidance_scale, "changed by the message"
    assert MotionRequest.from_dict(request.to_dict()) == request, "changed by its file"


def _from_dict(random: Random, folder: Path) -> None:
    _check(MotionRequest.from_dict(_tree(random)))


def _from_yaml(random: Random, folder: Path) -> None:
    try:
        text = yaml.safe_dump(_tree(random))
    except (yaml.YAMLError, ValueError):  # not everything can be written as YAML
        text = yaml.safe_dump(_valid(random))
    content = bytearray(text.encode("utf-8", errors="replace"))
    for _ in range(int(random.choice([0, 0, 1, 3, 20]))):
        at = int(random.integers(len(content)))
        way = random.random()
        if way < 0.4:
            content[at] = int(random.integers(256))
        elif way < 0.6:
            del content[at : at + int(random.integers(1, 30))]
        else:
            scrap = _pick(
                random, ("[" * 2000, "&a [*a]", "9" * 5000, "2024-99-99", "!!int x", "\0")
            )
            content[at:at] = scrap.encode()
        content = content or bytearray(b"0")
    file = folder / "request.yaml"
    file.write_bytes(bytes(content))
    _check(MotionRequest.from_yaml(file))


def _from_text(random: Random, folder: Path) -> None:
    way = random.random()
    if way < 0.2:
        text = str(_pick(random, TEXTS))
    elif way < 0.4:
        text = "".join(str(_pick(random, SCRAPS)) for _ in range(int(random.integers(1, 60))))
    elif way < 0.42:
        text = str(_pick(random, ("[", "[1", " ", "1", "[1 ", "[0-", "|"))) * 20000
    else:
        content = list("[0-4] a person walks | right_arm[2-4]: waves | head+torso[1-3] nods")
        for _ in range(int(random.choice([0, 1, 2, 5]))):
            at = int(random.integers(len(content)))
            if random.random() < 0.5:
                content[at] = str(_pick(random, SCRAPS))
            else:
                content.insert(at, str(_pick(random, (*SCRAPS, "9" * 400))))
        text = "".join(content)
    _check(MotionRequest.from_text(text))


def _from_message(random: Random, folder: Path) -> None:
    def number() -> float:
        return (
            float(_pick(random, NUMBERS)) if random.random() < 0.2 else float(random.uniform(0, 6))
        )

    def name() -> str:
        return str(_pick(random, NAMES) if random.random() < 0.15 else _pick(random, tuple(PARTS)))

    def whole(low: int, high: int) -> int:
        value = int(_pick(random, WHOLE)) if random.random() < 0.2 else int(random.integers(20))
        return min(max(value, low), high)

    def several(most: int) -> range:
        return range(300 if random.random() < 0.01 else int(random.integers(most)))

    message = MotionRequestMsg(
        segments=[
            MotionSegment(
                text=str(_pick(random, TEXTS)) if random.random() < 0.1 else "a person waves",
                start=number() if random.random() < 0.3 else 0.0,
                end=number() + 1.0,
                parts=[name() for _ in several(3)],
            )
            for _ in (range(1) if random.random() < 0.6 else several(4))
        ],
        duration=0.0 if random.random() < 0.7 else number(),
        seed=whole(-(2**63), 2**63 - 1),
        guidance_scale=number(),
        steps=whole(0, 2**32 - 1),
        candidates=whole(0, 2**32 - 1),
        robot="" if random.random() < 0.7 else str(_pick(random, NAMES)),
        waypoints=[
            WaypointMsg(time=number(), x=number(), y=number(), heading=number())
            for _ in (several(4) if random.random() < 0.2 else ())
        ],
    )
    if random.random() < 0.2:
        spans = [(number(), number()) for _ in several(3)]
        message.edit = MotionEdit(
            file=name(),
            regenerate=[name() for _ in several(3)],
            keep_start=[start for start, _ in spans],
            keep_end=[end for _, end in spans][: int(random.integers(len(spans) + 1)) or None],
        )
    _check(request_from_message(message, robot="humanoid"))


def _typed_numbers(random: Random, folder: Path) -> None:
    scraps = ("1", "0", ".", ",", "-", "e9", "e999", "nan", "inf", " ", "x", "–", "3,2", "9" * 400)
    text = "".join(str(_pick(random, scraps)) for _ in range(int(random.integers(1, 9))))
    parse = parse_waypoint if random.random() < 0.5 else parse_spans
    parse(text)


def _trajectory(random: Random, folder: Path) -> None:
    frames, joints = int(random.integers(1, 6)), int(random.integers(1, 4))
    unit = np.tile([1.0, 0.0, 0.0, 0.0], (frames, 1))
    zero = np.zeros((frames, 3))
    names = tuple(f"joint{j}" for j in range(joints))
    rest = np.array([0.0, 0.0, 1.0, 1.0, *np.zeros(3 + joints)])
    angles = random.normal(size=(2, frames, joints))
    whole = JointTrajectory(
        names, np.arange(frames) * 0.1, angles[0], angles[1], zero, unit, zero, zero
    )
    parts: tuple[Any, Any] = (
        joint_trajectory_to_message(whole, Header()),
        root_trajectory_to_message(whole, Header()),
    )
    message, root = copy.deepcopy(parts)
    for _ in range(int(random.choice([0, 1, 1, 2]))):
        if not message.points or not root.points:
            break
        at = int(random.integers(min(len(message.points), len(root.points))))
        joint_point, root_point, value = message.points[at], root.points[at], _pick(random, NUMBERS)
        match int(random.integers(9)):
            case 0 if joint_point.positions:
                joint_point.positions[0] = value
            case 1 if joint_point.velocities:
                joint_point.velocities[0] = value
            case 2:
                joint_point.positions = [*joint_point.positions, 0.0]
            case 3:
                seconds = int(_pick(random, (-5, 0, 2**31 - 1, -(2**31))))
                joint_point.time_from_start.sec = root_point.time_from_start.sec = seconds
            case 4:
                del message.points[at], root.points[at]
            case 5 if root_point.transforms:
                root_point.transforms[0].rotation.w = value
            case 6:
                root_point.velocities = []
            case 7:
                message.joint_names = [*list(message.joint_names)[1:], "joint0"]
            case 8 if root_point.transforms:
                root_point.transforms[0].translation.x = value
    read = trajectory_from_messages(message, root)
    # what the sim does with it
    path = ReferencePath.approach_and_follow(rest, read, approach_s=1.0)
    for elapsed in (0.0, 0.5, 1.0, 1.05, path.duration, path.duration + 1.0):
        path.at(elapsed)


KINDS: dict[str, Callable[[Random, Path], None]] = {
    "request message": _from_message,
    "request mapping": _from_dict,
    "request file": _from_yaml,
    "typed text": _from_text,
    "typed waypoint or span": _typed_numbers,
    "trajectory message": _trajectory,
}
SHARES = (0.35, 0.25, 0.1, 0.15, 0.05, 0.1)


def check_case(seed: int, folder: Path) -> tuple[str, str]:
    """Make one case and put it through.

    Args:
        seed: Of the case.
        folder: For files.

    Returns:
        The kind of input and the name of the error code; SUCCESS if it was taken.

    Raises:
        AssertionError: If a refusal lacks a code or a message, or what was taken did not survive.
        Exception: Whatever else came out.
    """
    random = np.random.default_rng(seed)
    kind = str(random.choice(list(KINDS), p=SHARES))
    try:
        KINDS[kind](random, folder)
    except MotionDiffuseError as refusal:
        error = refusal
    else:
        return kind, ErrorCode.SUCCESS.name
    line = str(error)
    assert error.code not in (ErrorCode.SUCCESS, ErrorCode.INTERNAL), f"no code: {line}"
    assert line.strip(), "no message"
    assert line.isprintable(), f"not one line: {line!r}"
    assert len(line) <= LONGEST_MESSAGE, f"{len(line)} characters"
    return kind, error.code.name


def main() -> int:
    """Run the cases; returns 1 if one failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first case")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    counts: dict[str, Counter[str]] = {kind: Counter() for kind in KINDS}
    failures: list[int] = []
    slowest, began = 0.0, time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(arguments.first, arguments.first + arguments.cases):
            start = time.perf_counter()
            try:
                kind, code = check_case(seed, Path(folder))
                counts[kind][code] += 1
            except Exception:
                failures.append(seed)
                if len(failures) <= 5:
                    print(f"case {seed}:\n{traceback.format_exc()}", file=sys.stderr)
            slowest = max(slowest, time.perf_counter() - start)
    codes = sorted({code for row in counts.values() for code in row})
    table = [
        [kind, sum(row.values()), *(row[code] for code in codes)] for kind, row in counts.items()
    ]
    for row in (["input", "cases", *codes], ["---"] * (len(codes) + 2), *table):
        print(f"| {' | '.join(map(str, row))} |")
    seconds = time.perf_counter() - began
    print(f"{len(failures)} failures; {seconds:.0f} s, the slowest case {slowest * 1e3:.0f} ms")
    if arguments.json:
        content = {
            "cases": arguments.cases,
            "failures": failures,
            "counts": counts,
            "seconds": round(seconds, 1),
            "slowest_case_s": round(slowest, 4),
        }
        arguments.json.write_text(json.dumps(content, indent=2) + "\n")
    return int(bool(failures))


if __name__ == "__main__":
    sys.exit(main())
