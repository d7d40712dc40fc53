"""T2M-S: texts on different parts of the body at once (eq. 10), measured.

    python -m benchmarks.composition_space [--limit N] [--weights DIR] [--steps 30] [--json F]

Rows: the real clips that the texts were said of; the same spliced; eq. 10 for several λ₁ (0 is hard
masks), and the same where parts are denoised apart above a noise level
(`SamplerConfig.apart_above`); parts of motions sampled apart put on one another; one joined
sentence; the first text alone. A part is judged on a standing body: all that was not given to its
text is replaced by a standing pose before the evaluator sees it. On real clips an arm's text is
then found first among 32 in 43 % of cases and among the first three in 90 %, a gait's in 47 and
78 %; where real clips are spliced and seen whole it is 15 and 29 %, 29 and 54 %.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import tyro

from benchmarks.composition_judging import (
    Bench,
    Figures,
    Settings,
    distance,
    precision,
)
from benchmarks.composition_lists import SPACE, Entry, load_list
from benchmarks.composition_sampling import Request
from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.evaluation.metrics import Estimate
from motiondiffuse_ros.evaluation.transitions import only_part, seam_gap, seam_jerk
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.parts import PARTS, part_joints
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.foot_skating import foot_skating

STAND_CLIP = "dataset-2_raise-up-right-hand_normal_071"
"""Its first frame is the standing pose that parts are judged on."""

_WINDOW = 80
"""Frames of the real windows of the FID: about the mean length of the list."""


@dataclass(frozen=True)
class SpaceSettings(Settings):
    """What to run."""

    apart: tuple[float, ...] = (0.25,)
    """Noise levels of the rows that denoise parts apart above them."""
    apart_corrections: tuple[float, ...] = (0.0, 0.5)
    """λ₁ of these rows, below the noise level."""


def arms_of(entry: Entry) -> tuple[str, ...]:
    """Return the arms that have texts of their own."""
    return tuple(part for p in entry.pieces for part in p.parts if part.endswith("_arm"))


def own_parts(entry: Entry, piece: int) -> tuple[str, ...]:
    """Return the parts that follow a piece's text; for the whole body those that none other has."""
    parts = entry.pieces[piece].parts
    taken = {part for p in entry.pieces for part in p.parts}
    return parts or tuple(part for part in PARTS if part not in taken)


def splice(entry: Entry, sources: Sequence[Motion], stand: Motion) -> Motion:
    """Put the parts of real windows on one another."""
    frames = sources[0].frames
    root = np.repeat(stand.root, frames, axis=0)
    rotations = np.repeat(stand.rotations, frames, axis=0)
    for i, source in enumerate(sources):
        parts = own_parts(entry, i)
        for part in parts:
            joints = list(part_joints(part))
            rotations[:, joints] = source.rotations[:, joints]
        if "legs" in parts:
            root = source.root
    return Motion(root, rotations, sources[0].fps, sources[0].skeleton)


class _Measure:
    """The columns of the table."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self.stand = bench.frame_of(STAND_CLIP)
        self._real = bench.real_windows(_WINDOW)

    def answers(self, whole: Sequence[Sequence[Motion]]) -> Figures:
        """Return R-precision by part of the motion of every piece of every entry."""
        bench = self._bench
        views, texts, arms, owner = [], [], [], []
        for e, (entry, motions) in enumerate(zip(bench.entries, whole, strict=True)):
            for i, (piece, motion) in enumerate(zip(entry.pieces, motions, strict=True)):
                views.append(only_part(motion, own_parts(entry, i), self.stand))
                texts.append(piece.text)
                arms.append(any(part.endswith("_arm") for part in piece.parts))
                owner.append(e)
        ranks = bench.retrieval.ranks(bench.embed(views), texts)
        arm = np.array(arms)
        worst = [ranks[np.array(owner) == e].max() for e in range(len(bench.entries))]
        return {
            **precision(ranks[arm], "arm"),
            **(precision(ranks[~arm], "gait") if not arm.all() else {}),
            "all parts R3": precision(np.array(worst), "")[" R3"],
        }

    def body(self, motions: Sequence[Motion], arms: Sequence[tuple[str, ...]]) -> Figures:
        """Return seam jerk, skating and FID."""
        jerk = [seam_jerk(m, parts) for m, parts in zip(motions, arms, strict=True) if parts]
        return {
            "arm jerk m/s³": Estimate.of(jerk),
            "skating": Estimate.of([foot_skating(m).ratio for m in motions]),
            "FID": distance(self._bench.embed(motions), self._real),
        }

    def sampled(self, features: Sequence[Array]) -> Figures:
        """Return every column of sampled features, one an entry."""
        entries, fps = self._bench.entries, self._bench.composer.fps
        arms = [arms_of(entry) for entry in entries]
        motions = [self._bench.decode(x) for x in features]
        each = [
            [motion] * len(entry.pieces) for motion, entry in zip(motions, entries, strict=True)
        ]
        gaps = [1000.0 * seam_gap(x, fps, a) for x, a in zip(features, arms, strict=True)]
        return {
            **self.answers(each),
            "seam gap mm": Estimate.of(gaps),
            **self.body(motions, arms),
        }


def _joined(entry: Entry) -> str:
    return " while ".join(piece.text for piece in entry.pieces)


def main() -> None:
    """Sample, measure and print the table."""
    settings = tyro.cli(SpaceSettings, description=__doc__)
    bench = Bench(settings, load_list(SPACE))
    measure, composer = _Measure(bench), bench.composer
    rows: dict[str, Figures] = {}

    sources = [[bench.real(piece) for piece in entry.pieces] for entry in bench.entries]
    arms = [p.parts if "legs" not in p.parts else () for e in bench.entries for p in e.pieces]
    flat = [motion for motions in sources for motion in motions]
    rows["real clips"] = measure.answers(sources) | measure.body(flat, arms)
    spliced = [splice(e, own, measure.stand) for e, own in zip(bench.entries, sources, strict=True)]
    rows["real clips, spliced"] = measure.body(spliced, [arms_of(e) for e in bench.entries])

    requests = [composer.request(composer.timed(e), composer.frames(e)) for e in bench.entries]
    for amount in settings.corrections:
        name = "hard masks (λ₁ = 0)" if amount == 0.0 else f"eq. 10, λ₁ = {amount:g}"
        features = composer.sample(requests, name, part_correction=amount)
        rows[name] = measure.sampled(features)
    for above in settings.apart:
        for amount in settings.apart_corrections:
            name = f"apart above {above:g}, λ₁ = {amount:g}"
            features = composer.sample(requests, name, part_correction=amount, apart_above=above)
            rows[name] = measure.sampled(features)
    rows["sampled apart, pasted"] = measure.sampled(composer.paste(requests, "pasted"))

    def whole_body(texts: Sequence[str], name: str) -> list[Array]:
        frames = [composer.frames(e) for e in bench.entries]
        alone: list[Request] = [
            composer.request([TimedText(text, 0, f)], f)
            for text, f in zip(texts, frames, strict=True)
        ]
        return composer.sample(alone, name)

    rows["one sentence, A while B"] = measure.sampled(
        whole_body([_joined(e) for e in bench.entries], "one sentence")
    )
    rows["first text alone"] = measure.sampled(
        whole_body([e.pieces[0].text for e in bench.entries], "first text")
    )
    bench.report("T2M-S: texts on parts", rows, list=SPACE.name)


if __name__ == "__main__":
    main()
