"""How well the verdict tells real clips from corrupted ones: the table of docs/physics.md.

    python benchmarks/physics_verdict.py --cmu DIR --bandai-namco DIR

Takes clips on level ground of both sets at random, up to 10 s of each, corrupts each in every
way, and prints the share of each verdict, the mean score and the area under the ROC of the score
(real against that corruption). A second table has the quantiles of real clips for each criterion,
which the thresholds were set from.
"""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from rich.table import Table

from motiondiffuse_ros.corpus import load_motion
from motiondiffuse_ros.errors import MotionFileError
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.physics import Report, assess
from motiondiffuse_ros.physics.criteria import CRITERIA

VERDICTS = ("plausible", "marginal", "implausible")
MAX_SECONDS, MIN_SECONDS = 10.0, 1.0
CAPTIONS = Path(__file__).parents[1] / "motiondiffuse_ros" / "corpus" / "captions"

# Clips whose description names one of these are not on level ground or lean on something.
NOT_LEVEL = re.compile(
    r"stair|climb|ladder|stool|chair|sit|seat|bench|sofa|couch|terrain|uneven|platform|beam|curb|"
    r"playground|swing|hang|pull up|monkey|bed\b|lie|lying|swim|motorcycle|two |partner|box|"
    r"hop over|jump off|step up|step over|stepping over|slope|ramp|hill|obstacle|cartwheel|"
    r"ledge|(and|to) (up|down)\b|skateboard|superhero|"
    r"acrobat|flip|trampoline|pole|handstand|crawl|roll|ball|mantis|car\b|door|wall|lean",
    re.IGNORECASE,
)


@dataclass
class Arguments:
    """Where the clips are and how many to take."""

    cmu: Path
    """Folder of the CMU BVH files."""
    bandai_namco: Path
    """Folder of the Bandai-Namco BVH files."""
    clips: int = 100
    """Clips of each set."""
    seed: int = 1
    """Of the choice and the corruptions."""
    json: Path | None = None
    """Also write the figures here."""


def moved(motion: Motion, by: np.ndarray) -> Motion:
    """Add a displacement [3] or [T, 3], m, to the path."""
    return replace(motion, root=motion.root + by)


def slid(speed: float) -> Callable[[Motion, np.random.Generator], Motion]:
    """Drift in a random horizontal direction."""

    def apply(motion: Motion, rng: np.random.Generator) -> Motion:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        times = np.arange(motion.frames)[:, None] / motion.fps
        return moved(motion, speed * times * np.array([np.cos(angle), np.sin(angle), 0.0]))

    return apply


def jittered(motion: Motion, rng: np.random.Generator) -> Motion:
    """Add noise to every frame: 3 degrees at every joint, 1 cm at the root."""
    noise = rot.from_rotation_vector(
        np.radians(3.0) * rng.normal(size=(*motion.rotations.shape[:2], 3))
    )
    shaken = replace(motion, rotations=rot.multiply(motion.rotations, noise))
    return moved(shaken, 0.01 * rng.normal(size=motion.root.shape))


def tilted(degrees: float) -> Callable[[Motion, np.random.Generator], Motion]:
    """Lean the body about the point of the floor under its root, in a random direction."""

    def apply(motion: Motion, rng: np.random.Generator) -> Motion:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        axis = np.array([np.cos(angle), np.sin(angle), 0.0])
        lean = rot.from_rotation_vector(np.radians(degrees) * axis)
        rotations = motion.rotations.copy()
        rotations[:, 0] = rot.multiply(lean, rotations[:, 0])
        height = motion.root * np.array([0.0, 0.0, 1.0])
        return moved(replace(motion, rotations=rotations), rot.rotate(lean, height) - height)

    return apply


def sped_up(factor: float) -> Callable[[Motion, np.random.Generator], Motion]:
    """Play faster."""
    return lambda motion, _: replace(motion, fps=motion.fps * factor).resample(20.0)


CORRUPTIONS: dict[str, Callable[[Motion, np.random.Generator], Motion]] = {
    "real": lambda motion, _: motion,
    "lifted 3 cm": lambda motion, _: moved(motion, np.array([0.0, 0.0, 0.03])),
    "lifted 5 cm": lambda motion, _: moved(motion, np.array([0.0, 0.0, 0.05])),
    "sunk 5 cm": lambda motion, _: moved(motion, np.array([0.0, 0.0, -0.05])),
    "slid 0.2 m/s": slid(0.2),
    "slid 0.5 m/s": slid(0.5),
    "jittered": jittered,
    "tilted 5 deg": tilted(5.0),
    "tilted 10 deg": tilted(10.0),
    "sped up 2x": sped_up(2.0),
    "sped up 3x": sped_up(3.0),
}


def choose_clips(arguments: Arguments, rng: np.random.Generator) -> list[tuple[str, Motion]]:
    """Return clips on level ground as (set, motion at 20 fps)."""
    level = set()
    for line in (CAPTIONS / "cmu_captions.jsonl").read_text(encoding="utf-8").splitlines():
        entry = json.loads(line)
        words = f"{entry['index']} {entry['subject']} {' '.join(entry['captions'])}"
        glitch = entry["max_joint_speed"] > 15.0 or entry["max_root_speed"] > 8.0
        if entry["captions"] and not glitch and not NOT_LEVEL.search(words):
            level.add(entry["clip"])
    sets = {
        "cmu": [p for p in sorted(arguments.cmu.glob("*.bvh")) if p.stem in level],
        "bandai-namco": sorted(arguments.bandai_namco.glob("*.bvh")),
    }
    chosen: list[tuple[str, Motion]] = []
    for name, paths in sets.items():
        taken = 0
        for index in rng.permutation(len(paths)):
            if taken == arguments.clips:
                break
            try:
                motion = load_motion(paths[index])
            except MotionFileError as error:
                Console(stderr=True).print(f"left out: {error}")
                continue
            if motion.duration >= MIN_SECONDS:
                motion = motion.resample(20.0)
                chosen.append((name, motion.slice(0, int(MAX_SECONDS * 20.0))))
                taken += 1
    return chosen


def area_under_roc(real: np.ndarray, corrupted: np.ndarray) -> float:
    """Return the chance that a real clip scores higher than a corrupted one."""
    difference = real[:, None] - corrupted[None]
    return float(np.mean((difference > 0.0) + 0.5 * (difference == 0.0)))


def verdict_figures(rows: dict[str, list[tuple[str, Report]]]) -> dict[str, dict[str, float]]:
    """Return shares of the verdicts, of what passes in each set, mean score and ROC area."""
    real = np.array([report.score for _, report in rows["real"]])
    figures = {}
    for kind, results in rows.items():
        scores = np.array([report.score for _, report in results])
        verdicts = np.array([report.verdict for _, report in results])
        sets = np.array([name for name, _ in results])
        figures[kind] = {v: float(np.mean(verdicts == v)) for v in VERDICTS}
        for name in ("cmu", "bandai-namco"):
            figures[kind][name] = float(np.mean(verdicts[sets == name] != "implausible"))
        figures[kind]["score"] = float(scores.mean())
        figures[kind]["roc_area"] = area_under_roc(real, scores)
    return figures


def verdict_table(figures: dict[str, dict[str, float]]) -> Table:
    """Lay out `verdict_figures`."""
    table = Table("", *VERDICTS, "not implausible: cmu", "bandai-namco", "mean score", "ROC area")
    for kind, row in figures.items():
        shares = [f"{row[key]:.0%}" for key in (*VERDICTS, "cmu", "bandai-namco")]
        area = "" if kind == "real" else f"{row['roc_area']:.3f}"
        table.add_row(kind, *shares, f"{row['score']:.2f}", area)
    return table


def quantile_table(real: list[tuple[str, Report]]) -> Table:
    """Return the criteria with quantiles over real clips and their thresholds."""
    quantiles = (0.5, 0.9, 0.95, 0.98)
    heads = [f"{name} {q:.0%}" for name in ("cmu", "b-n") for q in quantiles]
    table = Table("criterion", *heads, "marginal", "implausible")
    for criterion in CRITERIA:
        cells = []
        for name in ("cmu", "bandai-namco"):
            values = [report.metrics[criterion.name] or 0.0 for s, report in real if s == name]
            cells += [f"{v:.3g}" for v in np.quantile(values, quantiles)]
        table.add_row(criterion.name, *cells, str(criterion.marginal), str(criterion.implausible))
    return table


def main(arguments: Arguments) -> None:
    """Print the table and write the figures."""
    rng = np.random.default_rng(arguments.seed)
    clips = choose_clips(arguments, rng)
    rows: dict[str, list[tuple[str, Report]]] = {name: [] for name in CORRUPTIONS}
    seconds = spent = 0.0
    for name, motion in track(clips, description="clips"):
        for kind, corrupt in CORRUPTIONS.items():
            changed = corrupt(motion, rng)
            begin = time.perf_counter()
            report = assess(changed, track=False)
            spent += time.perf_counter() - begin
            seconds += changed.duration
            rows[kind].append((name, report))
    figures = verdict_figures(rows)
    Console().print(verdict_table(figures))
    Console().print(quantile_table(rows["real"]))
    Console().print(f"{len(clips)} clips; {seconds / spent:.0f} times real time on this machine")
    if arguments.json is not None:
        summary = {"rows": figures, "clips": len(clips), "seed": arguments.seed}
        arguments.json.write_text(json.dumps(summary | {"realtime_factor": seconds / spent}))


if __name__ == "__main__":
    main(tyro.cli(Arguments))
