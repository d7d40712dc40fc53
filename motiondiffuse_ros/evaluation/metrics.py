"""The metrics of section 4.1: functions of embeddings, as defined by Guo et al. 2022."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, eigvalsh

from motiondiffuse_ros.motion.rotations import Array, Indices

POOL = 32
TOPS = (1, 2, 3)


@dataclass(frozen=True)
class Estimate:
    """Mean over repeats with the half-width of its 95 % interval (1.96 standard errors)."""

    mean: float
    interval: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Estimate:
        """Summarise repeats."""
        spread = float(np.std(values, ddof=1)) if len(values) > 1 else 0.0
        return cls(float(np.mean(values)), 1.96 * spread / float(np.sqrt(len(values))))


def pools(texts: Sequence[str], rng: np.random.Generator, size: int = POOL) -> Iterator[Indices]:
    """Yield indices of random disjoint pools in which no two texts are the same.

    Two equal texts in a pool would make a right answer count as wrong; such pools are skipped.
    """
    order = rng.permutation(len(texts))
    for start in range(0, len(order) - size + 1, size):
        pool = order[start : start + size]
        if len({texts[i] for i in pool}) == size:
            yield pool


def retrieval(text: Array, motion: Array) -> tuple[Array, float]:
    """Rank motions for each text of one pool.

    Args:
        text: Embeddings [P, E].
        motion: Embeddings of the motions that belong to them [P, E].

    Returns:
        R-precision at each of `TOPS` [3] and the mean distance of the pairs (MultiModal distance).
    """
    distance = np.linalg.norm(text[:, None] - motion[None], axis=-1)
    own = np.diagonal(distance)
    # a tie is a wrong answer: a constant embedding must not score
    rank = (distance <= own[:, None]).sum(axis=1) - 1
    return np.array([(rank < top).mean() for top in TOPS]), float(own.mean())


def frechet_distance(a: Array, b: Array) -> float:
    """Return the Fréchet distance of Gaussians fitted to two sets of embeddings (FID)."""
    mean_a, mean_b = a.mean(axis=0), b.mean(axis=0)
    cov_a, cov_b = np.cov(a, rowvar=False), np.cov(b, rowvar=False)
    # the trace of (A B)^1/2 is that of (A^1/2 B A^1/2)^1/2, which is symmetric: safe where
    # covariances are singular
    values, vectors = eigh(cov_a)
    root_a = (vectors * np.sqrt(values.clip(min=0.0))) @ vectors.T
    root = np.sqrt(eigvalsh(root_a @ cov_b @ root_a).clip(min=0.0)).sum()
    return float(((mean_a - mean_b) ** 2).sum() + np.trace(cov_a) + np.trace(cov_b) - 2.0 * root)


def diversity(motion: Array, rng: np.random.Generator, pairs: int = 300) -> float:
    """Return the mean distance of random pairs of different motions [N, E]."""
    first = rng.integers(len(motion), size=pairs)
    second = (first + rng.integers(1, len(motion), size=pairs)) % len(motion)
    return float(np.linalg.norm(motion[first] - motion[second], axis=-1).mean())


def multimodality(groups: Sequence[Array], rng: np.random.Generator, pairs: int = 10) -> float:
    """Return the mean distance of random pairs of motions of the same text or action.

    Args:
        groups: For each text the embeddings of its motions [n, E]; groups of one have no pair.
        rng: Of the draws.
        pairs: Drawn from each group.
    """
    return float(np.mean([diversity(own, rng, pairs) for own in groups if len(own) > 1]))
