"""Fit the score of the physics report on the training split; writes physics/fitted_score.json.

    python benchmarks/fit_score.py --corpus runs/corpus

Draws clips on level ground of both sets, breaks each in some of the ways of
`benchmarks/corruptions.py`, and fits `physics.fitted_score.FittedScore` by stochastic gradients
with dropout and weight decay. Real and broken motions weigh the same in total. A clip's stillest
pose, held for a while, counts as real where the floor can carry it: to stand still is no fault.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import torch
import tyro
from rich.console import Console
from rich.progress import track
from scipy.special import expit
from torch import nn

from benchmarks.corruptions import CORRUPTIONS
from benchmarks.level_clips import level_clips
from benchmarks.physics_verdict import area_under_roc
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics import fitted_score
from motiondiffuse_ros.physics.body_states import humanoid_states
from motiondiffuse_ros.physics.dynamics import state_dynamics
from motiondiffuse_ros.physics.fitted_score import RANGE, FittedScore
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.measures import MIN_FRAMES
from motiondiffuse_ros.physics.statistics import statistics

REAL, STILL = "real", "still"
_FILE = Path(fitted_score.__file__).with_name("fitted_score.json")
_STILL_FRAMES = 60
_FOLDS = 5
_CARRIED = 0.05  # body weights, up to which the floor carries a still pose


@dataclass(frozen=True)
class Training:
    """How the network is fitted."""

    switches: int = 128
    """In its one layer."""
    epochs: int = 100
    """Passes over the motions."""
    batch: int = 256
    """Motions in a step."""
    learning_rate: float = 4e-3
    """At its highest."""
    decay: float = 0.3
    """Of the weights."""
    dropout: float = 0.3
    """Of the switches; of the statistics a third of it."""
    seed: int = 0
    """Of weights and order."""


@dataclass(frozen=True)
class Arguments:
    """What is fitted to."""

    corpus: Path
    """Corpus folder."""
    clips: int = 400
    """Of both sets together."""
    kinds: int = 8
    """Corruptions of each clip, drawn at random."""
    max_seconds: float = 8.0
    """Of each clip."""
    training: Training = Training()
    """Of the network."""
    plausible: float = 0.9
    """Share of real clips, held out, that the score alone calls plausible."""
    seed: int = 1
    """Of clips and corruptions."""
    cache: Path | None = None
    """File (npz) to keep the statistics in, and to take them from."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Statistics [N, S] of motions of some kinds [N], made of some clips [N]."""

    names: list[str]
    values: np.ndarray
    kinds: np.ndarray
    clips: np.ndarray


def main(arguments: Arguments) -> None:
    """Fit, print how well it fits, write."""
    samples = _samples(arguments)
    model = _fitted(samples, arguments.training)
    scores = _held_out_scores(samples, arguments.training)
    real = scores[samples.kinds == REAL]
    model = replace(
        model,
        marginal_below=float(np.quantile(real, 1.0 - arguments.plausible)),
    )
    for kind in CORRUPTIONS:
        broken = scores[samples.kinds == kind]
        area = area_under_roc(real, broken) if len(broken) else np.nan
        Console().print(f"{kind:>20}  {len(broken)} motions, area under ROC {area:.3f}")
    note = "made by benchmarks/fit_score.py, which see; not to be edited"
    settings = {k: v for k, v in asdict(arguments).items() if k not in ("corpus", "cache")}
    content = {"note": note, "settings": settings, "model": model.to_dict()}
    _FILE.write_text(json.dumps(content) + "\n", encoding="utf-8")


def _held_out_scores(samples: Samples, training: Training) -> np.ndarray:
    """Return the score of each motion by a model that was fitted without its clip [N]."""
    scores = np.empty(len(samples.kinds))
    for fold in range(_FOLDS):
        out = samples.clips % _FOLDS == fold
        rest = Samples(samples.names, *(a[~out] for a in _arrays(samples)))
        model = _fitted(rest, training)
        scores[out] = expit(model.odds(model.scaled(samples.values[out])))
    return scores


def _arrays(samples: Samples) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return samples.values, samples.kinds, samples.clips


def _samples(arguments: Arguments) -> Samples:
    if arguments.cache is not None and arguments.cache.exists():
        with np.load(arguments.cache) as data:
            return Samples(data["names"].tolist(), data["values"], data["kinds"], data["clips"])
    rng = np.random.default_rng(arguments.seed)
    corpus = Corpus.load(arguments.corpus)
    clips = level_clips(corpus, "train", arguments.clips, arguments.max_seconds, rng)
    rows: list[dict[str, float]] = []
    kinds: list[str] = []
    sources: list[int] = []
    for source, (_, motion) in enumerate(track(clips, description="clips")):
        drawn = rng.choice(list(CORRUPTIONS), min(arguments.kinds, len(CORRUPTIONS)), replace=False)
        broken = {kind: CORRUPTIONS[kind].apply(motion, rng) for kind in drawn.tolist()}
        for kind, made in ({REAL: motion, STILL: _still(motion)} | broken).items():
            if made.frames < MIN_FRAMES:
                continue
            states = humanoid_states(made, hinge_table())
            dynamics = state_dynamics(states)
            if kind == STILL and dynamics.residual_force.mean() > _CARRIED:
                continue
            rows.append(statistics(made, states, dynamics))
            kinds.append(kind)
            sources.append(source)
    values = np.array([list(row.values()) for row in rows])
    samples = Samples(list(rows[0]), values, np.array(kinds), np.array(sources))
    if arguments.cache is not None:
        np.savez(
            arguments.cache,
            names=samples.names,
            values=values,
            kinds=samples.kinds,
            clips=samples.clips,
        )
    return samples


def _still(motion: Motion) -> Motion:
    """Hold the pose in which a motion is slowest."""
    speed = np.linalg.norm(np.diff(motion.positions, axis=0), axis=-1).mean(axis=1)
    frames = np.full(_STILL_FRAMES, int(np.argmin(speed)))
    return replace(motion, root=motion.root[frames], rotations=motion.rotations[frames])


def _fitted(samples: Samples, training: Training) -> FittedScore:
    real = samples.values[samples.kinds == REAL]
    low, high = np.quantile(real, (0.05, 0.95), axis=0)
    count, switches = len(samples.names), training.switches
    empty = FittedScore(
        names=tuple(samples.names),
        centre=np.median(real, axis=0),
        spread=(high - low) / 2.0 + 1e-6,
        range=np.quantile(real, RANGE, axis=0),
        weights=np.zeros((switches, count)),
        offsets=np.zeros(switches),
        outward=np.zeros(switches),
        bias=0.0,
        marginal_below=0.0,
    )
    torch.manual_seed(training.seed)
    inward, outward = nn.Linear(count, switches), nn.Linear(switches, 1)
    network = nn.Sequential(
        nn.Dropout(training.dropout / 3.0),
        inward,
        nn.SiLU(),
        nn.Dropout(training.dropout),
        outward,
        nn.Flatten(0),
    )
    _train(network, empty.scaled(samples.values), np.isin(samples.kinds, (REAL, STILL)), training)
    weights, offsets, out, bias = (
        parameter.detach().double().numpy()
        for layer in (inward, outward)
        for parameter in (layer.weight, layer.bias)
    )
    return replace(empty, weights=weights, offsets=offsets, outward=out[0], bias=float(bias.item()))


def _train(network: nn.Module, scaled: np.ndarray, real: np.ndarray, training: Training) -> None:
    x, y = torch.tensor(scaled, dtype=torch.float32), torch.tensor(real, dtype=torch.float32)
    share = torch.where(y > 0.0, 0.5 / y.mean(), 0.5 / (1.0 - y.mean()))
    steps = training.epochs * len(x) // training.batch
    optimizer = torch.optim.AdamW(
        network.parameters(), lr=training.learning_rate, weight_decay=training.decay
    )
    rate = torch.optim.lr_scheduler.OneCycleLR(optimizer, training.learning_rate, steps)
    for _ in range(steps):
        drawn = torch.randint(len(x), (training.batch,))
        loss = nn.functional.binary_cross_entropy_with_logits(
            network(x[drawn]), y[drawn], share[drawn]
        )
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        rate.step()


if __name__ == "__main__":
    main(tyro.cli(Arguments))
