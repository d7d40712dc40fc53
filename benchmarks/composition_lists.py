"""The fixed lists of the composition benchmarks, and how they were drawn.

    python -m benchmarks.composition_lists [--corpus runs/corpus] [--seed 0] [--out benchmarks]

T2M-S (composition_space.json): texts for parts of the body at once. T2M-T (composition_time.json):
texts one after the other. Every text is a caption of a clip of the test split, and the window of
that clip which shows it is recorded beside it. A text is given to a part only if its words speak of
that part and the kinematics of its window show that it is done with that part alone.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from motiondiffuse_ros.corpus.store import Clip, Corpus
from motiondiffuse_ros.corpus.travel import Travel
from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion import rotations as rot

SPACE = Path(__file__).with_name("composition_space.json")
TIME = Path(__file__).with_name("composition_time.json")

_SPLIT = "test"
_MIN_FRAMES, _MAX_FRAMES, _LONGEST_CLIP = 50, 120, 160
_MAX_TEXT = 90
_ROUNDS = 100

_ARM_WORDS = re.compile(
    r"\b(hands?|arms?|wav(e|es|ing)|punch\w*|clap\w*|throw\w*|beckon\w*|point\w*|fists?|gestur\w*)\b",
    re.IGNORECASE,
)
_LEG_WORDS = re.compile(
    r"\b(walk\w*|runs?|running|jog\w*|march\w*|steps?|stepping|strid\w+|turn\w*|stroll\w*|trudg\w*"
    r"|sneak\w*|sprint\w*|dash\w*|backwards?|sidesteps?|paces?|foot|feet|legs?|sit\w*|seated|jump\w*"
    r"|hop\w*|kneel\w*|kick\w*)\b",
    re.IGNORECASE,
)
_GAIT_WORDS = re.compile(
    r"\b(walk\w*|runs?|running|jog\w*|march\w*|stroll\w*|trudg\w*|sneak\w*|sprint\w*|strid\w+)\b",
    re.IGNORECASE,
)
_BOTH = re.compile(r"\b(both|two|hands|arms)\b", re.IGNORECASE)
_SIDE = {
    side: re.compile(rf"\b{side}[ -]?(hand|arm|fist)\b", re.IGNORECASE)
    for side in ("left", "right")
}
_ARMS = {"left": ("left_arm",), "right": ("right_arm",), "both": ("left_arm", "right_arm")}


@dataclass(frozen=True)
class Piece:
    """A text and the real window it was said of.

    Attributes:
        text: A caption.
        parts: That it is given to; empty is the whole body.
        start: When it begins, s.
        end: When it ends, s.
        clip: Name of the clip.
        first: First frame of the window in the clip; as many follow as the piece lasts.
    """

    text: str
    parts: tuple[str, ...]
    start: float
    end: float
    clip: str
    first: int


@dataclass(frozen=True)
class Entry:
    """One request of a benchmark.

    Attributes:
        kind: What kind of composition it is.
        seconds: How long it lasts.
        pieces: Its texts.
    """

    kind: str
    seconds: float
    pieces: tuple[Piece, ...]


@dataclass(frozen=True)
class Options:
    """What to draw from."""

    corpus: Path = Path("runs/corpus")
    """Corpus folder."""
    seed: int = 0
    """Of all draws."""
    out: Path = SPACE.parent
    """Folder for the two lists."""


def load_list(path: Path) -> list[Entry]:
    """Read a list."""
    entries = json.loads(path.read_text(encoding="utf-8"))["entries"]
    return [
        Entry(
            e["kind"],
            e["seconds"],
            tuple(Piece(**{**p, "parts": tuple(p["parts"])}) for p in e["pieces"]),
        )
        for e in entries
    ]


class _Source:
    """Clips of the split that are short enough for a caption to be about all of them."""

    def __init__(self, corpus: Corpus, rng: np.random.Generator) -> None:
        self._corpus, self._rng = corpus, rng
        self.clips = [c for c in corpus.split(_SPLIT) if _MIN_FRAMES <= c.frames <= _LONGEST_CLIP]
        self._used: set[str] = set()

    def order(self, clips: Sequence[Clip]) -> Iterator[Clip]:
        """Yield clips: a data set by equal chance, then the clips of each in turn.

        Raises:
            CorpusError: When so many were drawn that no caption can be left.
        """
        stacks = [[c for c in clips if c.dataset == d] for d in sorted({c.dataset for c in clips})]
        places = [self._rng.permutation(len(stack)) for stack in stacks]
        counts = [0] * len(stacks)
        for _ in range(_ROUNDS * len(clips)):
            i = int(self._rng.integers(len(stacks)))
            yield stacks[i][places[i][counts[i] % len(stacks[i])]]
            counts[i] += 1
        raise CorpusError(
            f"the split '{_SPLIT}' has too few captions that fit for a list of this length"
        )

    def caption(
        self, clip: Clip, fits: Sequence[re.Pattern[str]] = (), not_: str = ""
    ) -> str | None:
        """Return a caption that was not used yet and satisfies the patterns, or None."""
        free = [
            text
            for text in clip.captions
            if len(text) <= _MAX_TEXT
            and text not in self._used
            and all(pattern.search(text) for pattern in fits)
            and not (not_ and re.search(not_, text, re.IGNORECASE))
        ]
        if not free:
            return None
        text = free[int(self._rng.integers(len(free)))]
        self._used.add(text)
        return text

    def arm_side(self, clip: Clip) -> str | None:
        """Return left, right or both for what is done with the arms on the spot, None otherwise."""
        features = self._corpus.of(clip)
        representation, fps = self._corpus.representation, self._corpus.fps
        way = Travel.of(features, representation, fps)
        height = features[:, representation.groups()["root_height"]]
        if way.path > 0.7 or abs(way.turned) > 0.5 or np.ptp(height) > 0.12:
            return None
        motion = representation.decode(features, fps)
        inverse = rot.conjugate(motion.global_rotations[:, motion.skeleton.index("spine3")])
        chest = motion.joint("spine3")
        paths = {}
        for side in ("left", "right"):
            place = rot.rotate(inverse, motion.joint(f"{side}_wrist") - chest)
            paths[side] = np.linalg.norm(np.diff(place, axis=0), axis=1).sum()
        more, less = sorted(paths, key=lambda s: -paths[s])
        if paths[more] < 0.6:
            return None
        return more if paths[more] > 2.0 * paths[less] else "both"

    def travels(self, clip: Clip) -> bool:
        """Return whether the legs carry the body somewhere."""
        way = Travel.of(self._corpus.of(clip), self._corpus.representation, self._corpus.fps)
        return way.speed > 0.4


def draw_space(corpus: Corpus, seed: int, counts: dict[str, int]) -> list[Entry]:
    """Draw part combinations.

    Args:
        corpus: With a test split.
        seed: Of all draws.
        counts: How many of each kind: "arms on a body" (a gait for the whole body, arms with a text
            of their own), "legs and arms" (the gait for the legs alone, torso and head stand),
            "two arms" (either arm its own text, the body stands).
    """
    rng = np.random.default_rng([seed, 0])
    source = _Source(corpus, rng)
    sides = {clip.name: source.arm_side(clip) for clip in source.clips}
    arm_clips = [clip for clip in source.clips if sides[clip.name]]
    gaits = source.order([c for c in source.clips if source.travels(c)])

    def arm(order: Iterator[Clip]) -> tuple[str, tuple[str, ...], Clip]:
        for clip in order:
            side = sides[clip.name]
            assert side is not None
            fits = [_ARM_WORDS, _BOTH if side == "both" else _SIDE[side]]
            text = source.caption(clip, fits, _LEG_WORDS.pattern)
            if text is not None:
                return text, _ARMS[side], clip
        raise AssertionError("the order raises before it ends")

    def gait() -> tuple[str, Clip]:
        for clip in gaits:
            text = source.caption(clip, [_GAIT_WORDS], _ARM_WORDS.pattern)
            if text is not None:
                return text, clip
        raise AssertionError("the order raises before it ends")

    any_arm = source.order(arm_clips)
    one = {
        side: source.order([c for c in arm_clips if sides[c.name] == side])
        for side in ("left", "right")
    }
    entries = []
    for kind, count in counts.items():
        for _ in range(count):
            if kind == "two arms":
                said = [arm(one["left"]), arm(one["right"])]
            else:
                text, clip = gait()
                said = [(text, ("legs",) if kind == "legs and arms" else (), clip), arm(any_arm)]
            frames = min(_MAX_FRAMES, *(clip.frames for _, _, clip in said))
            seconds = frames / corpus.fps
            pieces = tuple(
                Piece(text, parts, 0.0, seconds, clip.name, (clip.frames - frames) // 2)
                for text, parts, clip in said
            )
            entries.append(Entry(kind, seconds, pieces))
    return [entries[i] for i in rng.permutation(len(entries))]  # any first N are a fair mixture


def draw_time(corpus: Corpus, seed: int, count: int) -> list[Entry]:
    """Draw timelines of two to four whole-body texts of 2.5 to 6 s, no text twice in the list."""
    rng = np.random.default_rng([seed, 1])
    source = _Source(corpus, rng)
    clips = source.order(source.clips)
    entries = []
    for _ in range(count):
        pieces: list[Piece] = []
        wanted = int(rng.integers(2, 5))
        while len(pieces) < wanted:
            clip = next(clips)
            text = source.caption(clip)
            if text is None or clip.name in {p.clip for p in pieces}:
                continue
            frames = min(clip.frames, _MAX_FRAMES)
            start = pieces[-1].end if pieces else 0.0
            end = round(start + frames / corpus.fps, 3)
            pieces.append(Piece(text, (), start, end, clip.name, (clip.frames - frames) // 2))
        entries.append(Entry(f"{wanted} segments", pieces[-1].end, tuple(pieces)))
    return entries


def _write(path: Path, options: Options, entries: Sequence[Entry]) -> None:
    command = f"python -m benchmarks.composition_lists --seed {options.seed}"
    data: dict[str, Any] = {
        "command": command,
        "seed": options.seed,
        "split": _SPLIT,
        "entries": [asdict(entry) for entry in entries],
    }
    path.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


def main() -> None:
    """Draw and write both lists."""
    options = tyro.cli(Options)
    corpus = Corpus.load(options.corpus)
    # two arms first: texts for one given side are the scarcest
    counts = {"two arms": 24, "arms on a body": 64, "legs and arms": 32}
    _write(options.out / SPACE.name, options, draw_space(corpus, options.seed, counts))
    _write(options.out / TIME.name, options, draw_time(corpus, options.seed, 120))


if __name__ == "__main__":
    main()
