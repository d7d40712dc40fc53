"""Captions from kinematics: what can be stated with certainty of a window, as people would say it.

Captions name the action and leave direction, side, speed, distance and angle to chance. Statements
name just these, so that left and right, forward and backward, walk and run are learnt from every
clip. The rules are in `statement_rules`, the sentences here.
"""

from __future__ import annotations

from dataclasses import dataclass

from motiondiffuse_ros.corpus.statement_rules import Finding, findings
from motiondiffuse_ros.motion.features import PoseState, Representation
from motiondiffuse_ros.motion.rotations import Array

# {n}: a number of metres in words. Sided sentences are written for the left.
_SENTENCES: dict[str, tuple[str, ...]] = {
    "sideways": (
        "a person steps sideways to the left",
        "a person moves sideways to the left",
        "a person takes side steps to the left",
    ),
    "turn": ("a person turns to the left on the spot", "a person turns left"),
    "quarter turn": (
        "a person makes a quarter turn to the left",
        "a person turns left by about ninety degrees",
    ),
    "half turn": (
        "a person makes a half turn to the left",
        "a person turns around to the left and faces the other way",
    ),
    "curve": ("a person walks in a curve to the left", "a person walks and turns left"),
    "circle": (
        "a person walks around in a circle, always turning left",
        "a person goes all the way around a circle to the left",
    ),
    "run in a curve": ("a person runs in a curve to the left", "a person runs and turns left"),
    "one hand up": (
        "a person holds the left hand above the head",
        "a person raises the left hand above the head",
    ),
    "one hand waves": (
        "a person raises the left hand and waves with it",
        "a person waves the left hand from side to side",
    ),
    "one arm fast": (
        "a person moves the left arm fast and keeps the right arm calm",
        "a person makes a quick movement with the left hand",
    ),
    "one leg up": (
        "a person lifts the left foot high off the floor",
        "a person stands on the right leg and lifts the left leg",
    ),
    "one leg fast": (
        "a person swings the left leg up fast",
        "a person strikes out with the left foot",
    ),
    "walk": ("a person walks forward", "a person walks straight ahead"),
    "slow walk": ("a person walks forward slowly", "a person walks slowly"),
    "fast walk": ("a person walks forward quickly", "a person walks fast"),
    "distance": ("a person walks forward {n}", "a person walks {n} straight ahead"),
    "on the spot": ("a person steps on the spot", "a person walks in place without getting ahead"),
    "run": ("a person runs forward", "a person runs straight ahead"),
    "slow run": ("a person jogs straight ahead", "a person runs forward at an easy pace"),
    "fast run": ("a person sprints straight ahead", "a person runs forward very fast"),
    "back": ("a person walks backward", "a person steps back"),
    "both hands up": (
        "a person holds both hands above the head",
        "a person raises both hands above the head",
    ),
    "both hands wave": (
        "a person raises both hands and waves with them",
        "a person waves both hands from side to side",
    ),
    "arms out": (
        "a person holds both arms out sideways at shoulder height",
        "a person spreads the arms wide",
    ),
    "bow": (
        "a person bends forward at the waist and straightens up again",
        "a person bows forward and comes up again",
    ),
    "down low": (
        "a person bends the knees and goes down low",
        "a person lowers the body far down over bent legs",
    ),
    "reach down": (
        "a person reaches down to the floor with a hand",
        "a person bends down until a hand is near the floor",
    ),
    "jump": ("a person jumps", "a person jumps into the air with both feet"),
    "jumps": ("a person jumps again and again", "a person keeps jumping"),
    "still": ("a person stands still", "a person stays in place without moving"),
}
_NUMBERS = ("one", "two", "three", "four", "five", "six", "seven", "eight")

OPPOSED = (
    *("sideways", "turn", "curve", "run in a curve", "one hand up", "walk", "slow walk", "run"),
    *("back", "both hands up", "bow", "still", "one hand waves", "both hands wave"),
)
"""Kinds of which a motion can be only one: what a text does not say if it says another."""


@dataclass(frozen=True)
class Statement:
    """Something that is certain of a window.

    Attributes:
        kind: What it is about, without its side.
        texts: Sentences that say it, each as good as the other.
    """

    kind: str
    texts: tuple[str, ...]


def state(features: Array, representation: Representation, fps: float) -> tuple[Statement, ...]:
    """Return all that is certain of a window; often nothing.

    Args:
        features: Of the window [T, D], not normalised.
        representation: What they mean; nothing is stated of other than the pose state.
        fps: Their rate, Hz.
    """
    if representation.name != PoseState.name:
        return ()
    found = findings(features, representation, fps)
    return tuple(Statement(f.kind, _texts(f)) for f in found if f.metres <= len(_NUMBERS))


def all_statements() -> tuple[str, ...]:
    """Return every sentence that `state` may give."""
    return statements_of(tuple(_SENTENCES))


def statements_of(kinds: tuple[str, ...]) -> tuple[str, ...]:
    """Return every sentence of some kinds."""
    every = (f for kind in kinds for f in _forms(kind))
    return tuple(text for finding in every for text in _texts(finding))


def _forms(kind: str) -> tuple[Finding, ...]:
    if kind == "distance":
        return tuple(Finding(kind, metres=n + 1) for n in range(len(_NUMBERS)))
    if "left" in _SENTENCES[kind][0]:
        return Finding(kind, side=1), Finding(kind, side=-1)
    return (Finding(kind),)


def _texts(finding: Finding) -> tuple[str, ...]:
    sentences = _SENTENCES[finding.kind]
    if finding.side < 0:
        return tuple(map(_swap_sides, sentences))
    if finding.metres:
        way = f"{_NUMBERS[finding.metres - 1]} meter{'s' if finding.metres > 1 else ''}"
        return tuple(sentence.format(n=way) for sentence in sentences)
    return sentences


def _swap_sides(text: str) -> str:
    return "right".join(part.replace("right", "left") for part in text.split("left"))
