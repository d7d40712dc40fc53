"""Captions from kinematics: what can be stated with certainty of a window, as people would say it.

Captions name the action and leave direction, side, speed, distance and angle to chance. Statements
name just these, so that left and right, forward and backward, walk and run are learnt from every
clip. The rules are in `statement_rules`, the sentences here.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

from motiondiffuse_ros.corpus.captions import mirror_caption
from motiondiffuse_ros.corpus.statement_rules import FEW_STEPS, Finding, findings
from motiondiffuse_ros.corpus.wordings import wordings
from motiondiffuse_ros.motion.features import PoseState, Representation
from motiondiffuse_ros.motion.rotations import Array

# {n}: a number of metres or steps in words. Sided sentences are written for the left. The first two
# of a kind are what the choice among candidates compares with (`statements_of`).
_SENTENCES: dict[str, tuple[str, ...]] = {
    "sideways": (
        "a person steps sideways to the left",
        "a person moves sideways to the left",
        "a person takes side steps to the left",
        "a person goes to the left and faces ahead",
        "a person takes some steps to the left side",
    ),
    "turn": (
        "a person turns to the left on the spot",
        "a person turns left in place",
        "a person rotates to the left",
    ),
    "quarter turn": (
        "a person makes a quarter turn to the left",
        "a person turns left by about ninety degrees",
    ),
    "half turn": (
        "a person makes a half turn to the left",
        "a person turns around to the left and faces the other way",
        "a person turns the back to the front, going round by the left",
    ),
    "full turn": (
        "a person makes a full turn to the left on the spot",
        "a person spins all around to the left once",
    ),
    "curve": ("a person walks in a curve to the left", "a person walks and turns left"),
    "circle": (
        "a person walks around in a circle, always turning left",
        "a person goes all the way around a circle to the left",
    ),
    "in circles": (
        "a person walks around in a circle",
        "a person goes round and round in circles",
        "a person walks in a ring",
    ),
    "run in a curve": ("a person runs along a curve to the left", "a person runs and turns left"),
    "one hand up": (
        "a person holds the left hand above the head",
        "a person raises the left hand above the head",
        "a person puts up the left hand",
    ),
    "one hand waves": (
        "a person raises the left hand and waves with it",
        "a person waves the left hand from side to side",
        "a person waves with the left arm",
    ),
    "one arm fast": (
        "a person moves the left arm fast and keeps the right arm calm",
        "a person makes a quick movement with the left hand",
        "a person swings the left arm with force",
    ),
    "one leg up": (
        "a person lifts the left foot high off the floor",
        "a person stands on the right leg and lifts the left leg",
        "a person raises the left knee",
    ),
    "one leg fast": (
        "a person swings the left leg up fast",
        "a person strikes out with the left foot",
        "a person gives a kick with the left leg",
    ),
    "walk": (
        "a person walks forward",
        "a person walks straight ahead",
        "a person goes ahead on foot",
        "a person walks along",
        "a person takes steps ahead",
    ),
    "slow walk": (
        "a person walks forward slowly",
        "a person walks slowly",
        "a person goes ahead at a slow pace",
    ),
    "fast walk": (
        "a person walks forward quickly",
        "a person walks fast",
        "a person strides along in a hurry",
        "a person walks very fast, almost running",
    ),
    "distance": ("a person walks forward {n}", "a person walks {n} straight ahead"),
    "steps": ("a person goes {n} steps ahead", "a person takes {n} paces forward"),
    "on the spot": (
        "a person steps on the spot",
        "a person walks in place without getting ahead",
        "a person treads in place",
    ),
    "march": (
        "a person steps in place and lifts the knees high",
        "a person marches in place with high knees",
    ),
    "march ahead": (
        "a person marches ahead with high knees",
        "a person walks on and lifts the knees high",
        "a person marches along with raised knees",
    ),
    "tiptoe": (
        "a person walks forward on tiptoe",
        "a person walks on the toes with the heels up",
        "a person goes ahead on the balls of the feet",
    ),
    "run": (
        "a person runs forward",
        "a person runs straight ahead",
        "a person runs along",
        "a person goes at a run",
    ),
    "slow run": ("a person jogs straight ahead", "a person runs forward at an easy pace"),
    "fast run": (
        "a person sprints straight ahead",
        "a person runs forward very fast",
        "a person runs at full speed",
    ),
    "back": (
        "a person walks backward",
        "a person steps back",
        "a person walks backwards",
        "a person moves back and faces ahead",
        "a person takes steps backward",
        "a person walks straight backward",
        "a person backs up a few steps",
    ),
    "slow back": (
        "a person walks backward slowly",
        "a person steps back slowly and faces ahead",
        "a person goes backward at a slow pace",
    ),
    "steps back": ("a person goes {n} steps backward", "a person takes {n} paces back"),
    "two-handed swing": (
        "a person swings something with both hands",
        "a person strikes with a stick held in both hands",
        "a person swings both arms together with force",
    ),
    "both hands up": (
        "a person holds both hands above the head",
        "a person raises both hands above the head",
        "a person puts both hands up",
        "a person stretches both arms up over the head",
    ),
    "both hands wave": (
        "a person raises both hands and waves with them",
        "a person waves both hands from side to side",
        "a person waves with both arms",
    ),
    "arms out": (
        "a person holds both arms out sideways at shoulder height",
        "a person spreads the arms wide",
    ),
    "bow": (
        "a person bends forward at the waist and straightens up again",
        "a person bows forward and comes up again",
        "a person bows",
        "a person takes a bow",
    ),
    "down low": (
        "a person bends the knees and goes down low",
        "a person lowers the body far down over bent legs",
        "a person crouches down low",
        "a person squats with the knees bent",
    ),
    "sit down": (
        "a person sits down on a seat",
        "a person lowers the body onto a chair",
        "a person goes from standing to sitting",
    ),
    "on the knees": ("a person goes down on the knees", "a person kneels down"),
    "reach down": (
        "a person reaches down to the floor with a hand",
        "a person bends down until a hand is near the floor",
        "a person bends over and reaches for the feet",
    ),
    "jump": (
        "a person jumps",
        "a person jumps into the air with both feet",
        "a person leaps up",
    ),
    "jumps": ("a person jumps again and again", "a person keeps jumping"),
    "jumping jacks": (
        "a person performs jumping jacks",
        "a person does star jumps with arms and legs",
        "a person jumps with arms and legs apart and together again",
    ),
    "claps": (
        "a person claps with both hands",
        "a person brings the hands together again and again",
        "a person applauds",
    ),
    "jump ahead": ("a person jumps forward", "a person leaps forward with both feet"),
    "hops": (
        "a person hops on the left leg",
        "a person hops on one leg, the left",
        "a person jumps on the left foot and holds the right one up",
    ),
    "still": (
        "a person stands still",
        "a person stays in place without moving",
        "a person waits",
        "a person stands and does nothing",
        "a person stands around",
        "a person does not move",
    ),
}
_PERSON = "a person "
_OTHERS = ("a man ", "a woman ", "somebody ", "the figure ")
# verbs in the third person: the first word, and the one after "and"
_VERB = re.compile(r"(^|\band )(\w+?)(?:(?<=[gd]o)es|(?<=ch)es|s)\b")
_BODY = re.compile(r"\bthe (?=(?:left |right )?(?:hand|arm|leg|foot|feet|knee|head|palm|waist))")
_COMPARED = 2
_REVERSED = {"walk": "back", "slow walk": "slow back"}
_COUNTED = ("steps", "steps back")
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
        texts: Sentences that say it, each as good as the other; also in other words (`wordings`).
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


def state_in_reverse(statement: Statement) -> Statement | None:
    """Return what is certain of a window played backward, from what is certain of it played ahead.

    Walking backward is close to walking forward in reverse (Thorstensson 1986), and rare in data.
    """
    kind = _REVERSED.get(statement.kind)
    return Statement(kind, _texts(Finding(kind))) if kind else None


def all_statements() -> tuple[str, ...]:
    """Return every sentence that `state` may give."""
    return tuple(dict.fromkeys(t for f in _forms(tuple(_SENTENCES)) for t in _texts(f)))


def statements_of(kinds: tuple[str, ...]) -> tuple[str, ...]:
    """Return some sentences of each of some kinds, all of a person."""
    return tuple(text for form in _forms(kinds) for text in _sentences(form)[:_COMPARED])


def sentences_by_kind() -> dict[str, tuple[str, ...]]:
    """Return every sentence about a person by the kind of what it states."""
    return {
        kind: tuple(text for form in _forms_of(kind) for text in _sentences(form))
        for kind in _SENTENCES
    }


def _forms(kinds: tuple[str, ...]) -> tuple[Finding, ...]:
    return tuple(form for kind in kinds for form in _forms_of(kind))


def _forms_of(kind: str) -> tuple[Finding, ...]:
    if kind == "distance":
        return tuple(Finding(kind, metres=n + 1) for n in range(len(_NUMBERS)))
    if kind in _COUNTED:
        return tuple(Finding(kind, steps=n) for n in FEW_STEPS)
    if "left" in _SENTENCES[kind][0]:
        return Finding(kind, side=1), Finding(kind, side=-1)
    return (Finding(kind),)


@cache  # asked for every window of a corpus
def _texts(finding: Finding) -> tuple[str, ...]:
    voiced = (text for sentence in _sentences(finding) for text in _voices(sentence))
    return *voiced, *_filled(wordings(finding.kind), finding)


def _sentences(finding: Finding) -> tuple[str, ...]:
    return _filled(_SENTENCES[finding.kind], finding)


def _filled(texts: tuple[str, ...], finding: Finding) -> tuple[str, ...]:
    """Return texts written for the left, or for any number, as they are for a finding."""
    if finding.side < 0:
        return tuple(map(mirror_caption, texts))
    if finding.metres:
        way = f"{_NUMBERS[finding.metres - 1]} meter{'s' if finding.metres > 1 else ''}"
        return tuple(text.format(n=way) for text in texts)
    if finding.steps:
        return tuple(text.format(n=_NUMBERS[finding.steps - 1]) for text in texts)
    return texts


def _voices(sentence: str) -> tuple[str, ...]:
    """Return a sentence about a person, about others, and as it is said to somebody."""
    deed = sentence.removeprefix(_PERSON)
    told = _BODY.sub("your ", _VERB.sub(r"\1\2", deed))
    # twice: users tell rather than describe
    return sentence, *(other + deed for other in _OTHERS), told, told
