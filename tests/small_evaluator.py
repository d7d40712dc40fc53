"""A made corpus with three actions, and an evaluator small enough to learn them in seconds."""

import numpy as np
import pytest
from made_corpus import corpus_of
from synthetic import moved, standing, waving

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.evaluation.config import EvaluatorConfig, EvaluatorTraining
from motiondiffuse_ros.evaluation.training import train_evaluator
from motiondiffuse_ros.text import load_text_encoder

FRAMES = 48


def _gliding(speed):
    still = standing(FRAMES)
    times = np.arange(FRAMES)[:, None] / still.fps
    return moved(still, times * [speed, 0.0, 0.0])


@pytest.fixture(scope="session")
def made_corpus() -> Corpus:
    """40 clips a split: standing, waving with either hand, gliding ahead at various speeds."""
    entries = []
    for split in ("train", "val", "test"):
        for i in range(10):
            kinds = {
                "stand": (f"a person stands for the {i} th time", standing(FRAMES)),
                "wave-right-hand": (f"a person waves the right hand in way {i}", waving(FRAMES)),
                "wave-left-hand": (
                    f"a person waves the left hand in way {i}",
                    waving(FRAMES).mirrored(),
                ),
                "glide": (f"a person glides forward at speed {i}", _gliding(0.5 + 0.1 * i)),
            }
            entries += [
                (f"dataset-1_{kind}_{split}_{i:03d}", split, text, motion)
                for kind, (text, motion) in kinds.items()
            ]
    return corpus_of(entries)


@pytest.fixture(scope="session")
def encoder():
    """MiniLM."""
    return load_text_encoder("minilm")


@pytest.fixture(scope="session")
def evaluator(made_corpus, encoder):
    """Trained for 200 steps."""
    config = EvaluatorConfig(width=32, motion_layers=1, text_layers=1, space=16, dropout=0.0)
    training = EvaluatorTraining(steps=200, batch_size=24, learning_rate=3e-3, statements=0.0)
    return train_evaluator(made_corpus, encoder, config, training)
