"""What the two composition benchmarks share: real windows, retrieval of texts, tables."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from benchmarks.composition_lists import Entry, Piece
from benchmarks.composition_sampling import Composer
from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.errors import InputError
from motiondiffuse_ros.evaluation.evaluator import Evaluator, shipped_evaluator
from motiondiffuse_ros.evaluation.items import draw_window
from motiondiffuse_ros.evaluation.metrics import POOL, Estimate, frechet_distance
from motiondiffuse_ros.evaluation.tables import terminal_table
from motiondiffuse_ros.manifest import shipped
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.planner import PlannerConfig
from motiondiffuse_ros.text import load_text_encoder

_SAME = 0.9  # two texts this near in the evaluator's space say the same (`selection._SAME`)
_RESAMPLES = 200

Figures = dict[str, Estimate]


@dataclass(frozen=True)
class Settings:
    """What to run."""

    corpus: Path = Path("runs/corpus")
    """Corpus folder, for real motion."""
    weights: Path | None = None
    """Checkpoint folder; the shipped one if not given."""
    evaluator: Path | None = None
    """Evaluator folder; the shipped ruler if not given."""
    limit: int | None = None
    """Only the first entries of the list."""
    steps: int = PlannerConfig.steps
    """Denoising steps."""
    guidance_scale: float = PlannerConfig.guidance_scale
    """Weight of the text."""
    blend: float = 0.5
    """Time over which neighbours are blended, s."""
    corrections: tuple[float, ...] = (0.0, 0.5, 1.0)
    """λ of the rows of eq. 10 or eq. 11."""
    seed: int = 0
    """Of all noise and draws."""
    json: Path | None = None
    """Where to write the figures."""


class Bench:
    """Real motion, the ruler and the model, as the settings say."""

    def __init__(self, settings: Settings, entries: Sequence[Entry]) -> None:
        self.settings = settings
        self.entries = list(entries[: settings.limit])
        if not self.entries:
            raise InputError("the list is empty: give --limit 1 or more")
        self._corpus = Corpus.load(settings.corpus)
        self._clips = {clip.name: clip for clip in self._corpus.split("test")}
        self.evaluator = Evaluator.from_pretrained(
            settings.evaluator or shipped_evaluator(), load_text_encoder("minilm")
        )
        self.composer = Composer(
            settings.weights or shipped("base"),
            SamplerConfig(steps=settings.steps, guidance_scale=settings.guidance_scale),
            settings.seed,
            settings.blend,
        )
        # others are drawn from the whole list, however few of its entries are asked for
        self.retrieval = TextRetrieval(
            self.evaluator, [p.text for entry in entries for p in entry.pieces], settings.seed
        )

    def real(self, piece: Piece) -> Motion:
        """Return the window that a piece's text was said of."""
        fps = self._corpus.fps
        if piece.clip not in self._clips:
            raise InputError(
                f"the corpus has no test clip '{piece.clip}'; build it as docs/data_sets.md says, "
                "or draw the lists anew with `python -m benchmarks.composition_lists`"
            )
        frames = round((piece.end - piece.start) * fps)
        features = self._corpus.of(self._clips[piece.clip])
        return self.decode(features[piece.first : piece.first + frames])

    def frame_of(self, clip: str) -> Motion:
        """Return the first frame of a test clip."""
        return self.decode(self._corpus.of(self._clips[clip])[:1])

    def decode(self, features: Array) -> Motion:
        """Return the motion of features, as users get it."""
        return self._corpus.representation.decode(features, self._corpus.fps)

    def embed(self, motions: Iterable[Motion]) -> Array:
        """Return the evaluator's vectors [N, space]."""
        encode = self._corpus.representation.encode
        return self.evaluator.embed_motions([encode(motion) for motion in motions])

    def real_windows(self, frames: int) -> Array:
        """Return the vectors of a random window of every test clip of at least `frames`."""
        rng = np.random.default_rng([self.settings.seed, frames])
        return self.evaluator.embed_motions(
            [
                draw_window(self._corpus, clip, frames, rng)
                for clip in self._clips.values()
                if clip.frames >= frames
            ]
        )

    def report(self, title: str, rows: dict[str, Figures], **more: Any) -> None:
        """Print the table and write the JSON file, if one is asked for."""
        names = list(dict.fromkeys(name for figures in rows.values() for name in figures))
        cells = [[row, *(_cell(figures.get(n)) for n in names)] for row, figures in rows.items()]
        Console(width=200).print(terminal_table([["", *names], *cells], title))
        if self.settings.json is None:
            return
        settings = {
            name: value
            for name, value in asdict(self.settings).items()
            if name not in ("json", "weights", "evaluator", "corpus")
        }
        result = {
            "weights_sha256": self.composer.sha256,
            "evaluator_sha256": self.evaluator.sha256,
            "entries": len(self.entries),
            **settings,
            **more,
            "rows": {
                row: {name: [round(e.mean, 5), round(e.interval, 5)] for name, e in f.items()}
                for row, f in rows.items()
            },
        }
        self.settings.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


class TextRetrieval:
    """Is a motion nearer to its own text than to others of the list?

    For every text 31 others of the list are drawn that do not say the same in the evaluator's
    space; every method meets the same ones.
    """

    def __init__(self, evaluator: Evaluator, texts: Sequence[str], seed: int) -> None:
        self._texts = sorted(set(texts))
        self._index = {text: i for i, text in enumerate(self._texts)}
        self._vectors = evaluator.embed_texts(self._texts)
        self._rng_seed = seed

    @cached_property
    def _others(self) -> list[Array]:
        near = self._vectors @ self._vectors.T
        others = []
        for i in range(len(self._texts)):
            rng = np.random.default_rng([self._rng_seed, i])
            free = rng.permutation(np.flatnonzero(near[i] <= _SAME))[: POOL - 1]
            if len(free) < POOL - 1:
                raise InputError(f"fewer than {POOL - 1} texts differ from '{self._texts[i]}'")
            others.append(self._vectors[free])
        return others

    def ranks(self, motions: Array, texts: Sequence[str]) -> Array:
        """Return the rank [N] of each motion's own text, 0 to 31; a tie is a wrong answer.

        Args:
            motions: Unit vectors [N, space].
            texts: Of the list, one a motion.
        """
        ranks = []
        for vector, text in zip(motions, texts, strict=True):
            i = self._index[text]
            ranks.append(int((self._others[i] @ vector >= self._vectors[i] @ vector).sum()))
        return np.array(ranks)


def precision(ranks: Array, name: str) -> Figures:
    """Return R-precision at 1 and 3, with intervals over texts."""
    return {f"{name} R{top}": Estimate.of(list((ranks < top) * 1.0)) for top in (1, 3)}


def distance(one: Array, real: Array) -> Estimate:
    """Return the Fréchet distance to real windows; small sets make it large, so compare equals."""
    return Estimate(frechet_distance(one, real), 0.0)


def resampled(figure: Callable[[Array], float], rows: Array, seed: int) -> Estimate:
    """Return a figure of a set of rows with the half-width of its bootstrap 95 % interval."""
    rng = np.random.default_rng(seed)
    values = [figure(rows[rng.integers(len(rows), size=len(rows))]) for _ in range(_RESAMPLES)]
    return Estimate(figure(rows), float(1.96 * np.std(values)))


def _cell(value: Estimate | None) -> str:
    if value is None:
        return "–"
    spread = f" ± {_figure(value.interval)}" if value.interval > 0.0 else ""
    return f"{_figure(value.mean)}{spread}"


def _figure(value: float) -> str:
    """Return three digits, without an exponent."""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"
