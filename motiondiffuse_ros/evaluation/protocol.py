"""The paper's protocol for text-driven generation: repeats, pools, every source in one table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.evaluation.evaluator import Evaluator
from motiondiffuse_ros.evaluation.items import Item, draw_items
from motiondiffuse_ros.evaluation.metrics import (
    POOL,
    TOPS,
    diversity,
    frechet_distance,
    multimodality,
    pools,
    retrieval,
)
from motiondiffuse_ros.evaluation.plausibility import plausibility
from motiondiffuse_ros.evaluation.sources import MotionSource
from motiondiffuse_ros.evaluation.tally import Row, Tally
from motiondiffuse_ros.motion.rotations import Array, Indices


@dataclass(frozen=True)
class Protocol:
    """How figures are taken.

    Attributes:
        repeats: Times that everything is drawn and generated anew.
        texts_sampled: Texts that are answered several times, for MultiModality.
        samples: Answers to each of them.
        plausible_motions: Motions of each repeat and source whose physics is measured.
        seed: Of every draw.
    """

    repeats: int = 20
    texts_sampled: int = 10
    samples: int = 10
    plausible_motions: int = 40
    seed: int = 0

    def validate(self) -> None:
        """Raise InputError if a value is out of range."""
        for name in ("repeats", "texts_sampled", "plausible_motions"):
            if getattr(self, name) < 1:
                raise InputError(f"evaluation {name} must be at least 1, got {getattr(self, name)}")
        if self.samples < 2:
            raise InputError(f"evaluation samples must be at least 2, got {self.samples}")

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types."""
        return asdict(self)


def evaluate_texts(
    corpus: Corpus,
    split: str,
    evaluator: Evaluator,
    sources: Sequence[MotionSource],
    protocol: Protocol,
    on_progress: Callable[[str, int], None] | None = None,
) -> list[Row]:
    """Measure real motion, real training clips and every source.

    Args:
        corpus: Clips and captions.
        split: Which clips' captions are asked for; with "all" there is no row of training clips.
        evaluator: The ruler.
        sources: What answers them.
        protocol: How.
        on_progress: Called with a source's name and the repeats done.

    Raises:
        InputError: If the protocol is out of range or the split too small for a pool.
    """
    protocol.validate()
    tally = Tally()
    clips = corpus.split(split)
    training = () if split == "all" else corpus.split("train")
    longest = evaluator.network.config.max_frames
    for repeat in range(protocol.repeats):
        rng = np.random.default_rng([protocol.seed, repeat])
        items = draw_items(corpus, clips, longest, rng)
        if len(items) < POOL:
            raise InputError(
                f"the split '{split}' has {len(items)} clips of 2 s or more; a pool needs {POOL}"
            )
        texts = [item.text for item in items]
        frames = [len(item.features) for item in items]
        own = [item.clip for item in items]
        text = evaluator.embed_texts(texts)
        drawn = list(pools(texts, rng))
        if not drawn:
            raise InputError(
                f"no pool of {POOL} different captions could be drawn from the split '{split}'"
            )
        shown = rng.permutation(len(items))[: protocol.plausible_motions]
        windows = [item.features for item in items]
        # a second window of each clip, and clips that the model has learnt from: how far real
        # motion is from real motion
        again = _embed(evaluator, draw_items(corpus, clips, longest, rng))
        real = evaluator.embed_motions(windows)
        tally.add(
            "real",
            _right_answers(text, real, drawn)
            | _as_a_set(real, again, repeat)
            | _physics(corpus, [windows[i] for i in shown]),
        )
        if training:
            learnt = _same_data_sets(draw_items(corpus, training, longest, rng), items, rng)
            tally.add("training", _as_a_set(_embed(evaluator, learnt), real, repeat))
        for source in sources:
            seed = int(np.random.default_rng([protocol.seed, repeat, 2]).integers(2**31))
            answers = source.motions(texts, frames, seed, own)
            motion = evaluator.embed_motions(answers)
            figures = _right_answers(text, motion, drawn) | _as_a_set(motion, real, repeat)
            if source.generates:
                figures["multimodality"] = _multimodality(
                    source, items, evaluator, protocol, seed + 1
                )
            figures |= _physics(corpus, [answers[i] for i in shown])
            tally.add(source.name, figures)
            if on_progress is not None:
                on_progress(source.name, repeat + 1)
    return tally.rows()


def _embed(evaluator: Evaluator, items: Sequence[Item]) -> Array:
    return evaluator.embed_motions([item.features for item in items])


def _right_answers(text: Array, motion: Array, drawn: Sequence[Indices]) -> dict[str, float]:
    """Return how well the motions answer their own texts, over pools."""
    ranked = [retrieval(text[pool], motion[pool]) for pool in drawn]
    precision = np.mean([tops for tops, _ in ranked], axis=0)
    figures = {f"r_precision_top{top}": float(p) for top, p in zip(TOPS, precision, strict=True)}
    return {**figures, "mm_dist": float(np.mean([distance for _, distance in ranked]))}


def _as_a_set(motion: Array, real: Array, repeat: int) -> dict[str, float]:
    """Return how the motions compare with real ones and each other, whatever the texts."""
    pairs = np.random.default_rng(repeat)  # the same pairs for every source
    return {"fid": frechet_distance(motion, real), "diversity": diversity(motion, pairs)}


def _same_data_sets(
    candidates: Sequence[Item], items: Sequence[Item], rng: np.random.Generator
) -> list[Item]:
    """Draw as many candidates as there are items, of each data set as many as they have."""
    chosen: list[Item] = []
    for dataset in sorted({item.clip.dataset for item in items}):
        own = [c for c in candidates if c.clip.dataset == dataset]
        count = sum(item.clip.dataset == dataset for item in items)
        chosen += [own[i] for i in rng.permutation(len(own))[:count]]
    return chosen


def _multimodality(
    source: MotionSource,
    items: Sequence[Item],
    evaluator: Evaluator,
    protocol: Protocol,
    seed: int,
) -> float:
    chosen = np.random.default_rng(seed).permutation(len(items))[: protocol.texts_sampled]
    repeated = [items[i] for i in chosen for _ in range(protocol.samples)]
    motions = source.motions(
        [item.text for item in repeated],
        [len(item.features) for item in repeated],
        seed,
        [item.clip for item in repeated],
    )
    embedded = evaluator.embed_motions(motions).reshape(len(chosen), protocol.samples, -1)
    return multimodality(list(embedded), np.random.default_rng(seed))


def _physics(corpus: Corpus, features: Sequence[Array]) -> dict[str, float]:
    return plausibility(corpus.representation.decode(x, corpus.fps) for x in features)
