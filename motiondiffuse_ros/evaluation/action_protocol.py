"""Action-conditioned generation (section 4.2), by the protocol of ACTOR (Petrovich et al. 2021)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from motiondiffuse_ros.corpus.store import Clip, Corpus
from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.evaluation.actions import action_of
from motiondiffuse_ros.evaluation.evaluator import Evaluator
from motiondiffuse_ros.evaluation.items import draw_window
from motiondiffuse_ros.evaluation.metrics import diversity, frechet_distance, multimodality
from motiondiffuse_ros.evaluation.protocol import Protocol
from motiondiffuse_ros.evaluation.sources import MotionSource
from motiondiffuse_ros.evaluation.tally import Row, Tally
from motiondiffuse_ros.motion.rotations import Array

_MIN_FRAMES = 20


def clips_with_actions(corpus: Corpus, split: str, evaluator: Evaluator) -> list[Clip]:
    """Return the clips of a split whose action the recogniser knows."""
    return [
        clip
        for clip in corpus.split(split)
        if action_of(clip) in evaluator.actions and clip.frames >= _MIN_FRAMES
    ]


def evaluate_actions(
    corpus: Corpus,
    split: str,
    evaluator: Evaluator,
    sources: Sequence[MotionSource],
    protocol: Protocol,
    on_progress: Callable[[str, int], None] | None = None,
) -> list[Row]:
    """Ask every source for the labels of the split's clips, as often as they occur there.

    The label's words are the text and the real clip's length is the length. The row of real
    motion compares the clips with another window of each.

    Raises:
        InputError: If no clip of the split has an action that the recogniser knows.
    """
    protocol.validate()
    known = {label: i for i, label in enumerate(evaluator.actions)}
    clips = clips_with_actions(corpus, split, evaluator)
    if not clips:
        raise InputError(f"no clip of the split '{split}' has an action that the recogniser knows")
    labels = [str(action_of(clip)) for clip in clips]
    truth = np.array([known[label] for label in labels])
    longest = evaluator.network.config.max_frames
    tally = Tally()
    for repeat in range(protocol.repeats):
        rng = np.random.default_rng([protocol.seed, repeat, 1])
        windows = [draw_window(corpus, clip, longest, rng) for clip in clips]
        again = [draw_window(corpus, clip, longest, rng) for clip in clips]
        real = evaluator.embed_actions(windows)
        again = evaluator.embed_actions(again)
        tally.add("real", _figures(evaluator, windows, truth, again, repeat))
        for source in sources:
            seed = int(rng.integers(2**31))
            answers = source.motions(labels, [len(w) for w in windows], seed, clips)
            tally.add(source.name, _figures(evaluator, answers, truth, real, repeat))
            if on_progress is not None:
                on_progress(source.name, repeat + 1)
    return tally.rows()


def _figures(
    evaluator: Evaluator, motions: Sequence[Array], truth: Array, real: Array, repeat: int
) -> dict[str, float]:
    embedded, pairs = evaluator.embed_actions(motions), np.random.default_rng(repeat)
    groups = [embedded[truth == label] for label in np.unique(truth)]
    return {
        "accuracy": float((evaluator.recognise(motions) == truth).mean()),
        "fid": frechet_distance(embedded, real),
        "diversity": diversity(embedded, pairs),
        "multimodality": multimodality(groups, pairs),
    }
