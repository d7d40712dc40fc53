"""Do words that say the opposite give opposite motions? Sides, forward and backward, walk and run.

    python -m benchmarks.opposite_prompts [--seeds 8] [--evaluator DIR] [--weights DIR] [--json F]

Every prompt is planned, and judged twice: by a signed measure of its kinematics, and by an
evaluator that asks whether the motion is nearer to its prompt or to the opposite one. Give one
that had no part in training or choice. No prompt was used to choose weights or settings.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from benchmarks.kinematic_rules import height, joint_speed, path_length, travel, turned
from benchmarks.sampled_prompts import Sampling, sample_prompts
from motiondiffuse_ros.corpus.captions import mirror_caption
from motiondiffuse_ros.evaluation.evaluator import Evaluator, shipped_evaluator
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.features import REPRESENTATIONS
from motiondiffuse_ros.text import load_text_encoder

WALK_OR_RUN = 1.9
"""Mean speed along the way between a fast walk and a slow run [m/s]."""

Measure = Callable[[Motion], float]


@dataclass(frozen=True)
class Pair:
    """Two prompts that ask for opposites.

    Attributes:
        kind: Group of the table.
        one: The prompt whose motions measure above zero.
        other: The prompt whose motions measure below.
        measure: Of a motion that starts over the origin, facing +x.
    """

    kind: str
    one: str
    other: str
    measure: Measure


@dataclass(frozen=True)
class Options:
    """What to run."""

    evaluator: Path | None = None
    """Evaluator folder; the shipped one if not given."""
    json: Path | None = None
    """Where to write the counts."""
    sampling: tyro.conf.OmitArgPrefixes[Sampling] = field(default_factory=Sampling)


def _higher(part: str) -> Measure:
    return lambda m: float(height(m, f"left_{part}").max() - height(m, f"right_{part}").max())


def _faster(part: str) -> Measure:
    return lambda m: float(
        joint_speed(m, f"left_{part}").max() - joint_speed(m, f"right_{part}").max()
    )


def _aside(motion: Motion) -> float:
    return float(travel(motion)[1])


def _ahead(motion: Motion) -> float:
    return float(travel(motion)[0])


def _too_slow_to_walk(motion: Motion) -> float:
    return WALK_OR_RUN - path_length(motion) / motion.duration


_SIDED: dict[str, Measure] = {
    "raise the left hand": _higher("wrist"),
    "wave over here with your left hand": _higher("wrist"),
    "someone greets you with the left hand raised": _higher("wrist"),
    "lift up the left arm": _higher("wrist"),
    "hold the left hand over your head": _higher("wrist"),
    "say goodbye by waving the left arm": _higher("wrist"),
    "a person throws a ball with the left hand": _faster("wrist"),
    "throw a left punch": _faster("wrist"),
    "swing the left arm around": _faster("wrist"),
    "a person kicks with the left leg": _faster("foot"),
    "kick a ball with the left foot": _faster("foot"),
    "lift the left knee": _higher("foot"),
    "raise the left leg to the side": _higher("foot"),
    "turn to the left": turned,
    "a man turns left on the spot": turned,
    "go for a walk and turn left": turned,
    "walk in a circle, turning left": turned,
    "run around a bend to the left": turned,
    "step to the left": _aside,
    "someone sidesteps to the left": _aside,
    "walk sideways to the left": _aside,
    "shuffle to your left": _aside,
}
_DIRECTIONS = (
    ("go forward on foot", "go backward on foot"),
    ("take a step forward", "take a step back"),
    ("someone walks straight ahead", "someone walks straight back"),
    ("move forward slowly", "move backward slowly"),
    ("a man steps forward carefully", "a man steps backward carefully"),
)
_SPEEDS = (
    ("someone walks", "someone runs"),
    ("a man walks ahead", "a man runs ahead"),
    ("walk straight on", "run straight on"),
    ("a woman is walking", "a woman is running"),
    ("walk at an easy pace", "run at a fast pace"),
)

PAIRS = (
    *(Pair("left or right", text, mirror_caption(text), m) for text, m in _SIDED.items()),
    *(Pair("forward or backward", *texts, _ahead) for texts in _DIRECTIONS),
    *(Pair("walk or run", *texts, _too_slow_to_walk) for texts in _SPEEDS),
)


@dataclass(frozen=True)
class Verdict:
    """How many samples of one prompt are on its side.

    Attributes:
        kind: Of the pair.
        text: The prompt.
        kinematics: By the measure.
        evaluator: By the evaluator.
        both: By both.
        samples: Of how many.
    """

    kind: str
    text: str
    kinematics: int
    evaluator: int
    both: int
    samples: int


def judge(pair: Pair, motions: dict[str, list[Motion]], evaluator: Evaluator) -> Iterator[Verdict]:
    """Yield the verdict on each of a pair's prompts."""
    representation = REPRESENTATIONS[evaluator.representation]()
    texts = evaluator.embed_texts([pair.one, pair.other])
    for sign, own, text in ((1.0, 0, pair.one), (-1.0, 1, pair.other)):
        measured = np.array([sign * pair.measure(motion) > 0.0 for motion in motions[text]])
        embedded = evaluator.embed_motions([representation.encode(m) for m in motions[text]])
        near = embedded @ texts[own] > embedded @ texts[1 - own]
        yield Verdict(
            pair.kind,
            text,
            int(measured.sum()),
            int(near.sum()),
            int((measured & near).sum()),
            len(measured),
        )


def main() -> None:
    """Plan the prompts, judge them and print the tables."""
    options = tyro.cli(Options)
    evaluator = Evaluator.from_pretrained(
        options.evaluator or shipped_evaluator(), load_text_encoder("minilm")
    )
    plans, settings = sample_prompts(
        [text for pair in PAIRS for text in (pair.one, pair.other)], options.sampling
    )
    motions = {text: [plan.motion for plan in own] for text, own in plans.items()}
    verdicts = [v for pair in PAIRS for v in judge(pair, motions, evaluator)]
    table = Table("prompt", "kinematics", "evaluator", "both", "of")
    for v in verdicts:
        table.add_row(v.text, *map(str, (v.kinematics, v.evaluator, v.both, v.samples)))
    totals = Table("kind", "kinematics", "evaluator", "both", "samples")
    shares: dict[str, dict[str, float]] = {}
    for kind in dict.fromkeys(v.kind for v in verdicts):
        own = [v for v in verdicts if v.kind == kind]
        samples = sum(v.samples for v in own)
        shares[kind] = {
            name: sum(getattr(v, name) for v in own) / samples
            for name in ("kinematics", "evaluator", "both")
        }
        totals.add_row(kind, *(f"{share:.1%}" for share in shares[kind].values()), str(samples))
    Console().print(table, totals)
    if options.json is not None:
        result = {
            **settings,
            "evaluator_sha256": evaluator.sha256,
            "shares": shares,
            "rows": [vars(v) for v in verdicts],
        }
        options.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
