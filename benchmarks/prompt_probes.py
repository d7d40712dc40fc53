"""Do samples do what the words say? Prompts judged by kinematic rules, through the planner.

    python -m benchmarks.prompt_probes [--prompts readme] [--seeds 8] [--json F] [--sheet PNG]

Six prompts and a mirror image; `--prompts free` asks the longer list of `free_prompts`, whose texts
are in no training data, `--prompts tuning` those to look at while settings are chosen. Rules are
stated beside each; figures are counts over seeds.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from benchmarks.free_prompts import FREE_PROMPTS
from benchmarks.kinematic_rules import Rule, travel
from benchmarks.sampled_prompts import Sampling, sample_prompts
from benchmarks.tuning_prompts import TUNING_PROMPTS
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.render import contact_sheet


@dataclass(frozen=True)
class Probe:
    """A prompt and what must hold.

    Attributes:
        text: The prompt.
        rule: In words.
        holds: Of a motion and the mean distance of the walking prompt [m].
    """

    text: str
    rule: str
    holds: Callable[[Motion, float], bool]


@dataclass(frozen=True)
class Options:
    """What to run."""

    prompts: Literal["readme", "free", "tuning"] = "readme"
    """Which list."""
    json: Path | None = None
    """Where to write the counts."""
    sheet: Path | None = None
    """Where to draw one sample of each prompt."""
    sheet_seed: int = 0
    """Which seed the sheet shows."""
    sampling: tyro.conf.OmitArgPrefixes[Sampling] = field(default_factory=Sampling)


def travelled(motion: Motion) -> float:
    """Return the distance [m] between the first and last root position over the ground."""
    return float(np.linalg.norm(travel(motion)[:2]))


def _walks_ahead(motion: Motion, _: float) -> bool:
    x, y = motion.root[-1, :2]
    return x > 2.0 and abs(np.degrees(np.arctan2(y, x))) < 30.0


def _runs(motion: Motion, walk: float) -> bool:
    return travelled(motion) >= 1.5 * walk


def _both_hands_up(motion: Motion, _: float) -> bool:
    head = motion.joint("head")[:, 2]
    left, right = (motion.joint(f"{side}_wrist")[:, 2] > head for side in ("left", "right"))
    return bool((left & right).any())


def _waves(side: str, other: str) -> Callable[[Motion, float], bool]:
    def holds(motion: Motion, _: float) -> bool:
        wrist, shoulder = motion.joint(f"{side}_wrist"), motion.joint(f"{side}_shoulder")
        up = wrist[:, 2] > shoulder[:, 2]
        moved = np.linalg.norm(np.diff(wrist - shoulder, axis=0), axis=1)
        while_up = float(moved[up[1:] & up[:-1]].sum())
        idle = motion.joint(f"{other}_wrist")[:, 2] < motion.joint(f"{other}_shoulder")[:, 2]
        return up.sum() >= 10 and while_up > 0.5 and bool(idle.all())

    return holds


def _bows(motion: Motion, _: float) -> bool:
    head = motion.joint("head")[:, 2]
    lowest = int(np.argmin(head))
    return head[0] - head[lowest] >= 0.15 and head[lowest:].max() - head[lowest] >= 0.10


def _sidesteps_left(motion: Motion, _: float) -> bool:
    x, y = motion.root[-1, :2] - motion.root[0, :2]
    return y > 0.2 and y > x


PROBES = (
    Probe("a person walks forward", "over 2 m ahead, within 30° of straight", _walks_ahead),
    Probe("a person runs forward", "1.5 times as far as the walks' mean", _runs),
    Probe("a person raises both hands", "both wrists above the head at once", _both_hands_up),
    Probe(
        "a person waves with the right hand",
        "right wrist over its shoulder and moving 0.5 m, left below its own throughout",
        _waves("right", "left"),
    ),
    Probe(
        "a person waves with the left hand",
        "the mirror image",
        _waves("left", "right"),
    ),
    Probe("a person bows", "head 15 cm down and at least 10 cm up again", _bows),
    Probe(
        "a person sidesteps to the left",
        "over 20 cm left and more left than ahead",
        _sidesteps_left,
    ),
)


def _ruled(rules: Mapping[str, Rule]) -> tuple[Probe, ...]:
    return tuple(
        Probe(text, rule.words, lambda motion, _, rule=rule: rule.holds(motion))
        for text, rule in rules.items()
    )


LISTS = {"readme": PROBES, "free": _ruled(FREE_PROMPTS), "tuning": _ruled(TUNING_PROMPTS)}


def main() -> None:
    """Run the probes and print the table."""
    options = tyro.cli(Options)
    probes = LISTS[options.prompts]
    plans, settings = sample_prompts([probe.text for probe in probes], options.sampling)
    motions = {text: [plan.motion for plan in own] for text, own in plans.items()}
    walk = float(np.mean([travelled(m) for m in motions[probes[0].text]]))
    seeds = options.sampling.seeds
    table = Table("prompt", "rule", f"holds of {seeds}", "plausible or marginal")
    rows = []
    for probe in probes:
        passed = [seed for seed, m in enumerate(motions[probe.text]) if probe.holds(m, walk)]
        sound = sum(p.report.verdict != "implausible" for p in plans[probe.text])
        table.add_row(probe.text, probe.rule, str(len(passed)), str(sound))
        rows.append({"text": probe.text, "passed": passed, "not_implausible": sound})
    Console().print(table)
    counts = [len(row["passed"]) for row in rows]
    held, asked = sum(counts), seeds * len(rows)
    print(f"{held} of {asked} samples hold ({held / asked:.1%}); least {min(counts)} of a prompt")
    if options.json is not None:
        result = {
            **settings,
            "walk_m": round(walk, 3),
            "held": held,
            "asked": asked,
            "rows": rows,
        }
        options.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    if options.sheet is not None:
        shown = [(p.text, motions[p.text][options.sheet_seed]) for p in probes]
        contact_sheet(shown, options.sheet)


if __name__ == "__main__":
    main()
