"""Training of the evaluator, on the training split alone."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional as F

from motiondiffuse_ros.corpus.store import Clip, Corpus
from motiondiffuse_ros.diffusion.precision import use_bf16
from motiondiffuse_ros.evaluation.actions import action_of, actions_of
from motiondiffuse_ros.evaluation.config import EvaluatorConfig, EvaluatorTraining
from motiondiffuse_ros.evaluation.evaluator import Evaluator
from motiondiffuse_ros.evaluation.network import ActionNetwork, TextMotionNetwork
from motiondiffuse_ros.text import TextEncoder
from motiondiffuse_ros.training.texts import CaptionStates, all_captions, other_words_of, texts_of
from motiondiffuse_ros.training.windows import WindowBatch, WindowSampler

_ALIKE = 0.9
_DIRECTIONS = re.compile(
    r"\b(left|right|both|forwards?|back|backwards?|up|down|clockwise|counterclockwise)\b"
)

Progress = Callable[[str, float, float], None]
"""Called with what is trained, the share done and the running loss."""


def train_evaluator(
    corpus: Corpus,
    encoder: TextEncoder,
    begin: EvaluatorConfig | Evaluator,
    training: EvaluatorTraining,
    on_progress: Progress | None = None,
) -> Evaluator:
    """Train the text-motion evaluator and, where clips have actions, the action recogniser.

    Args:
        corpus: Whose training split is learnt.
        encoder: Of the texts.
        begin: Layout of new networks, or an evaluator whose text-motion network is trained on and
            whose recogniser is kept.
        training: How to train.
        on_progress: Told of every step.
    """
    clips = corpus.split("train")
    torch.manual_seed(training.seed)
    fresh = isinstance(begin, EvaluatorConfig)
    config = begin if fresh else begin.network.config
    network = TextMotionNetwork(config) if fresh else deepcopy(begin.network)
    windows = _windows(
        *(corpus, clips, config, training, training.statements), other_words=other_words_of
    )
    captions = CaptionStates(all_captions(clips, windows.stated_texts()), encoder)

    def pair_loss(batch: WindowBatch) -> Tensor:
        tokens = captions.batch(batch.texts)
        text = network.embed_text(tokens.states, tokens.mask)
        motion = network.embed_motion(batch.features, batch.lengths)
        logits = network.log_scale.clamp(max=4.0).exp() * (text @ motion.T)
        logits = logits.masked_fill(not_wrong(batch, tokens.pooled()), -1e4)
        own = torch.arange(len(logits))
        return 0.5 * (F.cross_entropy(logits, own) + F.cross_entropy(logits.T, own))

    pairs = windows.batches(training.batch_size)
    _fit(network, pairs, pair_loss, training, training.minutes, "text and motion", on_progress)

    if not fresh:
        return replace(begin, network=network.eval())
    labelled = [clip for clip in clips if action_of(clip) is not None]
    actions = actions_of(labelled)
    recogniser = ActionNetwork(config, len(actions)) if actions else None
    if recogniser is not None:
        _fit_recogniser(recogniser, corpus, labelled, actions, config, training, on_progress)
    return Evaluator(
        network.eval(),
        None if recogniser is None else recogniser.eval(),
        actions,
        corpus.statistics,
        corpus.representation.name,
        encoder,
    )


def _fit_recogniser(
    recogniser: ActionNetwork,
    corpus: Corpus,
    labelled: Sequence[Clip],
    actions: Sequence[str],
    config: EvaluatorConfig,
    training: EvaluatorTraining,
    on_progress: Progress | None,
) -> None:
    index = {label: i for i, label in enumerate(actions)}

    def loss(batch: WindowBatch) -> Tensor:
        logits = recogniser(batch.features, batch.lengths)
        return F.cross_entropy(logits, torch.tensor([index[text] for text in batch.texts]))

    windows = _windows(corpus, labelled, config, training, 0.0, _labels)
    batches = windows.batches(training.batch_size)
    _fit(recogniser, batches, loss, training, training.action_minutes, "actions", on_progress)


def not_wrong(batch: WindowBatch, pooled: Tensor) -> Tensor:
    """Return [B, B] bool: pairs of a text and another's motion that are no wrong answer.

    That is a text the motion might have come with, or one that says the same: close in the space
    of the text encoder and with the same words of direction, which that space hardly tells apart.
    TMR drops these from its loss likewise.

    Args:
        batch: Windows.
        pooled: Unit vectors of the texts [B, D].
    """
    said = [tuple(sorted(_DIRECTIONS.findall(text.lower()))) for text in batch.texts]
    way = np.array([hash(words) for words in said])
    alike = (pooled @ pooled.T > _ALIKE) & torch.from_numpy(way[:, None] == way[None])
    same = torch.tensor([[text in words for words in batch.synonyms] for text in batch.texts])
    mask = alike | same | same.T
    mask.fill_diagonal_(False)
    return mask


def _windows(
    corpus: Corpus,
    clips: Sequence[Clip],
    config: EvaluatorConfig,
    training: EvaluatorTraining,
    statements: float,
    texts: Callable[[Clip], Sequence[str]] = texts_of,
    other_words: Callable[[Clip], Sequence[str]] = lambda clip: (),
) -> WindowSampler:
    return WindowSampler(
        corpus,
        clips,
        max_frames=config.max_frames,
        mirror=0.5,
        statements=statements,
        texts=texts,
        other_words=other_words,
        seed=training.seed,
    )


def _labels(clip: Clip) -> tuple[str, ...]:
    """Return the label as the only text, so that mirroring swaps its side."""
    label = action_of(clip)
    assert label is not None
    return (label,)


def _fit(
    module: torch.nn.Module,
    batches: Iterator[WindowBatch],
    loss_of: Callable[[WindowBatch], Tensor],
    training: EvaluatorTraining,
    minutes: float,
    what: str,
    on_progress: Progress | None,
) -> None:
    optimizer = torch.optim.AdamW(
        module.parameters(), lr=training.learning_rate, weight_decay=training.weight_decay
    )
    module.train()
    began, mean, step = time.monotonic(), 0.0, 0
    while True:
        elapsed = (time.monotonic() - began) / (60.0 * minutes)
        done = step / training.steps if training.steps else elapsed
        if done >= 1.0:
            return
        step += 1
        warmup = min(1.0, done / 0.02 + 0.01)
        for group in optimizer.param_groups:
            group["lr"] = training.learning_rate * warmup * 0.5 * (1.0 + math.cos(math.pi * done))
        with torch.autocast("cpu", torch.bfloat16, enabled=use_bf16("auto")):
            loss = loss_of(next(batches))
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(module.parameters(), 1.0)
        optimizer.step()
        mean = loss.item() if mean == 0.0 else 0.98 * mean + 0.02 * loss.item()
        if on_progress is not None:
            on_progress(what, done, mean)
