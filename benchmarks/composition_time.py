"""T2M-T: texts one after the other (eq. 11), measured.

    python -m benchmarks.composition_time [--limit N] [--weights DIR] [--steps 30] [--json F]

Rows: the real clips that the texts were said of; eq. 11 for several λ₂ (0 is weighted blending of
the predictions); segments sampled one by one and blended linearly, or cut hard (its segments are
single samples: the most that composition can keep of each text); one joined sentence.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import tyro

from benchmarks.composition_judging import (
    Bench,
    Figures,
    Settings,
    distance,
    precision,
    resampled,
)
from benchmarks.composition_lists import TIME, Entry, load_list
from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.evaluation.metrics import Estimate
from motiondiffuse_ros.evaluation.transitions import (
    area_under_jerk,
    around,
    max_jerk,
    peak_jerk,
    transition_distance,
)
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.foot_skating import foot_skating

_SEGMENT = 80
_SEAM_SECONDS = 2.0
"""Crops around a transition for their FID: the shortest motion that the evaluator knows."""


class _Measure:
    """The columns of the table."""

    def __init__(self, bench: Bench, usual: float) -> None:
        self._bench, self._usual = bench, usual
        self._segments = bench.real_windows(_SEGMENT)
        self._seams = bench.real_windows(round(_SEAM_SECONDS * bench.composer.fps))

    def __call__(
        self,
        segments: Sequence[Motion],
        texts: Sequence[str],
        motions: Sequence[Motion],
        transitions: Sequence[Sequence[int]],
    ) -> Figures:
        """Return every column.

        Args:
            segments: Cropped out of the motions.
            texts: Of the segments.
            motions: Whole ones.
            transitions: Of each motion, the first frame of every segment but the first.
        """
        bench = self._bench
        fps = bench.composer.fps
        places = [(m, t) for m, own in zip(motions, transitions, strict=True) for t in own]
        windows = [w for m, t in places if (w := around(m, t)) is not None]
        seams = [w for m, t in places if (w := around(m, t, _SEAM_SECONDS)) is not None]
        jerk = np.stack([max_jerk(w) for w in windows])
        steps = np.concatenate(
            [transition_distance(m, own) for m, own in zip(motions, transitions, strict=True)]
        )
        embedded = bench.embed(segments)
        seed = bench.settings.seed

        def area(rows: Array) -> float:
            return area_under_jerk(rows.mean(axis=0), self._usual, fps)

        return {
            **precision(bench.retrieval.ranks(embedded, texts), "segment"),
            "FID": distance(embedded, self._segments),
            "PJ m/s³": resampled(lambda rows: peak_jerk(rows.mean(axis=0)), jerk, seed),
            "AUJ m/s²": resampled(area, jerk, seed),
            "transition cm": Estimate.of(list(100.0 * steps)),
            "FID seams": distance(bench.embed(seams), self._seams),
            "skating": Estimate.of([foot_skating(m).ratio for m in motions]),
        }


def _joined(entry: Entry) -> str:
    return ", then ".join(piece.text for piece in entry.pieces)


def main() -> None:
    """Sample, measure and print the table."""
    settings = tyro.cli(Settings, description=__doc__)
    bench = Bench(settings, load_list(TIME))
    composer, entries = bench.composer, bench.entries
    real = [bench.real(piece) for entry in entries for piece in entry.pieces]
    usual = float(np.concatenate([max_jerk(motion) for motion in real]).mean())
    measure = _Measure(bench, usual)
    texts = [piece.text for entry in entries for piece in entry.pieces]
    timed = [composer.timed(entry) for entry in entries]
    frames = [composer.frames(entry) for entry in entries]

    def sampled(features: Sequence[Array]) -> Figures:
        motions = [bench.decode(x) for x in features]
        crops = [
            m.slice(t.start, t.stop) for m, own in zip(motions, timed, strict=True) for t in own
        ]
        return measure(crops, texts, motions, [[t.start for t in own[1:]] for own in timed])

    rows: dict[str, Figures] = {}
    # real clips have no transition: their middle shows what jerk and movement are usual
    rows["real clips"] = measure(real, texts, real, [[m.frames // 2] for m in real])
    requests = [composer.request(t, f) for t, f in zip(timed, frames, strict=True)]
    for amount in settings.corrections:
        name = "weighted blend (λ₂ = 0)" if amount == 0.0 else f"eq. 11, λ₂ = {amount:g}"
        rows[name] = sampled(composer.sample(requests, name, time_correction=amount))
    rows["one by one, blended"] = sampled(composer.paste(requests, "one by one, blended"))
    cut = [composer.request(t, f, blend_frames=0) for t, f in zip(timed, frames, strict=True)]
    rows["one by one, hard cut"] = sampled(composer.paste(cut, "one by one, hard cut"))
    sentences = [
        composer.request([TimedText(_joined(e), 0, f)], f)
        for e, f in zip(entries, frames, strict=True)
    ]
    rows["one sentence, A, then B"] = sampled(composer.sample(sentences, "one sentence"))
    bench.report(
        "T2M-T: texts one after the other", rows, list=TIME.name, usual_jerk_m_s3=round(usual, 2)
    )


if __name__ == "__main__":
    main()
