"""Fit the score of the physics report on the training split; writes physics/fitted_score.json.

    python benchmarks/fit_score.py --corpus runs/corpus

Draws clips on level ground of both sets, breaks each in some of the ways of
`benchmarks/corruptions.py`, and fits `physics.fitted_score.FittedScore` by logistic regression with
a penalty on the weights. Real and broken motions weigh the same in total. A clip's stillest pose,
held for a while, counts as real where the floor can carry it: to stand still is no fault.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from scipy.optimize import minimize
from scipy.special import expit

from benchmarks.corruptions import CORRUPTIONS
from benchmarks.level_clips import level_clips
from benchmarks.physics_verdict import area_under_roc
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics import fitted_score
from motiondiffuse_ros.physics.body_states import humanoid_states
from motiondiffuse_ros.physics.dynamics import state_dynamics
from motiondiffuse_ros.physics.fitted_score import KNOTS, FittedScore
from motiondiffuse_ros.physics.hinge_table import hinge_table
from motiondiffuse_ros.physics.measures import MIN_FRAMES
from motiondiffuse_ros.physics.statistics import statistics

REAL, STILL = "real", "still"
_FILE = Path(fitted_score.__file__).with_name("fitted_score.json")
_STILL_FRAMES = 60
_FOLDS = 5
_CARRIED = 0.05  # body weights, up to which the floor carries a still pose


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
    penalty: float = 0.002
    """On the squared weights."""
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
    model = _fitted(samples, arguments.penalty)
    scores = _held_out_scores(samples, arguments.penalty)
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


def _held_out_scores(samples: Samples, penalty: float) -> np.ndarray:
    """Return the score of each motion by a model that was fitted without its clip [N]."""
    scores = np.empty(len(samples.kinds))
    for fold in range(_FOLDS):
        out = samples.clips % _FOLDS == fold
        rest = Samples(samples.names, *(a[~out] for a in _arrays(samples)))
        model = _fitted(rest, penalty)
        odds = np.tensordot(model.basis(samples.values[out]), model.weights, 2)
        scores[out] = expit(model.bias + odds)
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


def _fitted(samples: Samples, penalty: float) -> FittedScore:
    real = samples.values[samples.kinds == REAL]
    low, high = np.quantile(real, (0.05, 0.95), axis=0)
    count = len(samples.names)
    empty = FittedScore(
        names=tuple(samples.names),
        centre=np.median(real, axis=0),
        spread=(high - low) / 2.0 + 1e-6,
        knots=np.quantile(real, KNOTS, axis=0),
        weights=np.zeros((len(KNOTS) + 1, count)),
        bias=0.0,
        marginal_below=0.0,
    )
    basis = empty.basis(samples.values).reshape(len(samples.values), -1)
    good = np.isin(samples.kinds, (REAL, STILL))
    share = np.where(good, 0.5 / good.sum(), 0.5 / (~good).sum())

    def cost(unknowns: np.ndarray) -> tuple[float, np.ndarray]:
        odds = unknowns[0] + basis @ unknowns[1:]
        loss = share @ (np.logaddexp(0.0, odds) - good * odds)
        slope = share * (expit(odds) - good)
        penalised = penalty * unknowns[1:]
        gradient = np.append(slope.sum(), slope @ basis + penalised)
        return float(loss + penalised @ unknowns[1:] / 2.0), gradient

    start = np.zeros(basis.shape[1] + 1)
    found = minimize(cost, start, jac=True, method="L-BFGS-B", options={"maxiter": 500}).x
    return replace(empty, bias=float(found[0]), weights=found[1:].reshape(-1, count))


if __name__ == "__main__":
    main(tyro.cli(Arguments))
