"""What the repair and the choice among candidates do to generated motions.

    python benchmarks/repair.py --corpus runs/corpus            (all clips of the test split)
    python benchmarks/repair.py --corpus runs/corpus --quick    (32 clips)

Answers a caption of every clip of the test split that lasts two seconds or more with several
candidates, feet held in the loop of denoising (`planted_below`) or not, and prints phys-err and
its parts, skating, jerk, R-precision by the shipped evaluator, the mean score and the share of
implausible motions: of the first candidate as it is sampled, put on the floor, repaired, and of
the candidate that the planner would choose, repaired.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.progress import track
from rich.table import Table

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.composition import TimedText
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.evaluation.evaluator import Evaluator, critic_of, shipped_evaluator
from motiondiffuse_ros.evaluation.items import Item, draw_items
from motiondiffuse_ros.evaluation.metrics import POOL, pools, retrieval
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.features import Representation
from motiondiffuse_ros.physics.foot_skating import foot_skating
from motiondiffuse_ros.physics.ground_contact import ground_errors
from motiondiffuse_ros.physics.repair import put_on_floor, repair, repair_best
from motiondiffuse_ros.physics.report import IMPLAUSIBLE, assess
from motiondiffuse_ros.physics.smoothness import joint_jerk
from motiondiffuse_ros.planner import shipped_weights
from motiondiffuse_ros.selection import TextMatch, eligible

_QUICK_CLIPS, _QUICK_STEPS = 32, 15
_POOL_DRAWS = 20
_COLUMNS = (
    *("phys_err_mm", "penetrate_mm", "float_mm", "skate_mm", "skating_ratio", "median_jerk"),
    *("r_precision_top1", "r_precision_top3", "score", "implausible"),
)


@dataclass(frozen=True)
class Arguments:
    """What is generated and measured."""

    corpus: Path
    """Corpus folder."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    candidates: int = 4
    """Motions for each text."""
    seed: int = 0
    """Of captions, windows and sampling."""
    quick: bool = False
    """Few clips and few denoising steps."""
    cache: Path | None = None
    """Folder to keep sampled motions in, and to take them from."""
    json: Path | None = None
    """Also write the figures here."""


def main(arguments: Arguments) -> None:
    """Print the table and write the figures."""
    rng = np.random.default_rng(arguments.seed)
    corpus = Corpus.load(arguments.corpus)
    pipeline = MotionPipeline.from_pretrained(arguments.weights or shipped_weights())
    evaluator = Evaluator.from_pretrained(shipped_evaluator(), pipeline.encoder)
    critic = Evaluator.from_pretrained(
        critic_of(arguments.weights or shipped_weights()), pipeline.encoder
    )
    longest = evaluator.network.config.max_frames
    items = draw_items(corpus, corpus.split("test"), longest, rng)
    if arguments.quick:
        items = [items[i] for i in rng.permutation(len(items))[:_QUICK_CLIPS]]
    real = [corpus.representation.decode(item.features, corpus.fps) for item in items]
    rows = {"real": real}
    default = SamplerConfig(steps=_QUICK_STEPS) if arguments.quick else SamplerConfig()
    for name, planted in (("plain", 0.0), ("planted in the loop", default.planted_below)):
        config = replace(default, planted_below=planted)
        sets = _sampled(pipeline, items, config, arguments)
        rows[name] = sets[0]
        rows[f"{name}, on the floor"] = [put_on_floor(m) for m in sets[0]]
        rows[f"{name}, repaired"] = [repair(m).motion for m in track(sets[0], "repairing")]
        rows[f"{name}, repaired, best of {arguments.candidates}"] = [
            _best(critic, item.text, choice, corpus.representation)
            for item, choice in track(list(zip(items, zip(*sets, strict=True), strict=True)))
        ]
    figures = {
        name: _figures(motions, items, evaluator, corpus.representation, arguments.seed)
        for name, motions in rows.items()
    }
    Console(width=200).print(_table(figures))
    if arguments.json is not None:
        settings = {"clips": len(items), "seed": arguments.seed, "sampler": asdict(default)}
        arguments.json.write_text(json.dumps({"rows": figures, **settings}, indent=1))


def _best(
    critic: Evaluator, text: str, motions: Sequence[Motion], representation: Representation
) -> Motion:
    """Choose as the planner does: among those that match the text, the most plausible."""
    whole = TimedText(text, 0, motions[0].frames)
    matches = TextMatch(critic, [whole])([representation.encode(m) for m in motions])
    able = eligible(dict(enumerate(matches)))
    return repair_best({i: put_on_floor(motions[i]) for i in able})[1].motion


def _sampled(
    pipeline: MotionPipeline, items: Sequence[Item], config: SamplerConfig, arguments: Arguments
) -> list[list[Motion]]:
    """Return the motions of each candidate."""
    sets = []
    for candidate in range(arguments.candidates):
        seed = arguments.seed + 1 + candidate
        name = f"{pipeline.weights_sha256[:12]}_{len(items)}_{seed}_{config.steps}"
        path = (arguments.cache or Path()) / f"{name}_{config.planted_below}.npz"
        if arguments.cache is not None and path.exists():
            sets.append(_load(path))
            continue
        frames = [len(item.features) for item in items]
        motions = pipeline.batch([i.text for i in items], frames, config=config, seed=seed)
        sets.append(list(motions))
        if arguments.cache is not None:
            arguments.cache.mkdir(parents=True, exist_ok=True)
            _save(path, motions)
    return sets


def _save(path: Path, motions: Sequence[Motion]) -> None:
    arrays = {f"root_{n}": m.root for n, m in enumerate(motions)}
    arrays |= {f"rotations_{n}": m.rotations for n, m in enumerate(motions)}
    np.savez(path, allow_pickle=False, fps=motions[0].fps, **arrays)


def _load(path: Path) -> list[Motion]:
    with np.load(path) as data:
        fps, count = float(data["fps"]), len(data.files) // 2
        return [Motion(data[f"root_{n}"], data[f"rotations_{n}"], fps) for n in range(count)]


def _figures(
    motions: Sequence[Motion],
    items: Sequence[Item],
    evaluator: Evaluator,
    representation: Representation,
    seed: int,
) -> dict[str, float]:
    rows, verdicts = [], []
    for motion in motions:
        ground = ground_errors(motion)
        parts = (ground.phys_err, ground.penetrate, ground.float_, ground.skate)
        jerk = float(np.median(joint_jerk(motion).max(axis=1)))
        rows.append([*(float(p.mean()) for p in parts), foot_skating(motion).ratio, jerk])
        report = assess(motion, track=False)
        verdicts.append([report.score, float(report.verdict == IMPLAUSIBLE)])
    texts = [item.text for item in items]
    text = evaluator.embed_texts(texts)
    motion = evaluator.embed_motions([representation.encode(m) for m in motions])
    rng = np.random.default_rng(seed)
    drawn = [pool for _ in range(_POOL_DRAWS) for pool in pools(texts, rng, min(POOL, len(texts)))]
    tops = (
        np.mean([retrieval(text[p], motion[p])[0] for p in drawn], axis=0)
        if drawn
        else [np.nan] * 3
    )
    values = [*np.mean(rows, axis=0), tops[0], tops[2], *np.mean(verdicts, axis=0)]
    return dict(zip(_COLUMNS, map(float, values), strict=True))


def _table(figures: dict[str, dict[str, float]]) -> Table:
    table = Table("", *_COLUMNS)
    for name, row in figures.items():
        table.add_row(name, *(f"{row[column]:.3g}" for column in _COLUMNS))
    return table


if __name__ == "__main__":
    main(tyro.cli(Arguments))
