"""Draw a long motion as a sheet: a row for every whole-body text of its request.

motiondiffuse generate --request docs/timeline.yaml --out out/
python -m benchmarks.timeline_sheet --plan out --out docs/timeline.png
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import tyro

from motiondiffuse_ros.motion_file import read_motion
from motiondiffuse_ros.render import contact_sheet
from motiondiffuse_ros.request import MotionRequest, Segment


@dataclass(frozen=True)
class Options:
    """What to draw."""

    plan: Path
    """Folder that `motiondiffuse generate` wrote."""
    out: Path = Path("docs/timeline.png")
    """The picture."""


def main() -> None:
    """Draw the sheet."""
    options = tyro.cli(Options)
    plan = json.loads((options.plan / "plan.json").read_text(encoding="utf-8"))
    request = MotionRequest.from_dict(plan["request"])
    motion = read_motion(options.plan / "motion.npz")
    rows = []
    for segment in request.segments:
        if not segment.parts:
            span = (round(segment.start * motion.fps), round(segment.end * motion.fps))
            rows.append((_caption(segment, request), motion.slice(*span)))
    contact_sheet(rows, options.out)


def _caption(segment: Segment, request: MotionRequest) -> str:
    """Return the text with its time, and what parts are told meanwhile."""
    words = f"[{segment.start:g}-{segment.end:g}] {segment.text}"
    meanwhile = [
        f"{'+'.join(s.parts)}[{s.start:g}-{s.end:g}]: {s.text}"
        for s in request.segments
        if s.parts and s.start < segment.end and s.end > segment.start
    ]
    return " | ".join([words, *meanwhile])


if __name__ == "__main__":
    main()
