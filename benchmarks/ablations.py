"""The paper's ablations on our data: text encoder, attention, width, with equal training time.

    python -m benchmarks.ablations [--corpus DIR] [--out DIR] [--minutes 5] [--json F]

Each variant is trained from scratch on one thread for the same processor time, whatever else the
machine does, and measured on the validation split by the shipped ruler. So little training shows
what learns fastest, not what is best in the end.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import torch
import tyro
from rich.console import Console

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.checkpoint import Checkpoint
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.pipeline import MotionPipeline
from motiondiffuse_ros.diffusion.sampler_config import SamplerConfig
from motiondiffuse_ros.evaluation.evaluator import Evaluator, shipped_evaluator
from motiondiffuse_ros.evaluation.protocol import Protocol, evaluate_texts
from motiondiffuse_ros.evaluation.sources import Model
from motiondiffuse_ros.evaluation.tables import (
    metrics_cells,
    plausibility_cells,
    rows_to_json,
    terminal_table,
)
from motiondiffuse_ros.evaluation.tally import Row
from motiondiffuse_ros.memory import keep_freed_memory
from motiondiffuse_ros.text import TextEncoder, TokenStates, load_text_encoder
from motiondiffuse_ros.text.encoder import sort_out_padding
from motiondiffuse_ros.text.minilm import model_folder
from motiondiffuse_ros.training.config import TrainConfig
from motiondiffuse_ros.training.trainer import CHECKPOINT_FOLDER, Trainer

BASE = DenoiserConfig()
UNTRAINED = "untrained words"


class UntrainedWords:
    """A random vector for each of MiniLM's word pieces: the trainable layers get no help."""

    name, dim, sha256 = UNTRAINED, BASE.text_dim, ""

    def __init__(self, seed: int = 0) -> None:
        from tokenizers import Tokenizer

        self._tokenizer = Tokenizer.from_file(str(model_folder() / "tokenizer.json"))
        self._tokenizer.enable_padding()
        generator = torch.Generator().manual_seed(seed)
        size = (self._tokenizer.get_vocab_size(), self.dim)
        # of the length of MiniLM's states, so that nothing but their content differs
        self._vectors = 0.3 * torch.randn(size, generator=generator)

    def encode(self, texts: Sequence[str]) -> TokenStates:
        """Return [N, L, dim]; places of words are lost, as attention's maps are sums over them."""
        encodings = self._tokenizer.encode_batch(list(texts))
        ids = torch.tensor([e.ids for e in encodings])
        mask = torch.tensor([e.attention_mask for e in encodings])
        return sort_out_padding(self._vectors[ids], mask)


VARIANTS: dict[str, DenoiserConfig] = {
    "default: MiniLM, efficient, 384 wide": BASE,
    "text encoder not pretrained": replace(BASE, text_encoder=UNTRAINED),
    "full attention": replace(BASE, attention="full"),
    "128 wide": replace(BASE, width=128),
    "256 wide": replace(BASE, width=256),
    "512 wide": replace(BASE, width=512),
    "a frame a token": replace(BASE, patch_size=1),
}


@dataclass(frozen=True)
class Options:
    """What to run."""

    corpus: Path = Path("runs/corpus")
    """Corpus folder."""
    out: Path = Path("runs/ablations")
    """Folder of the runs; those that are there are measured again, not trained again."""
    minutes: float = 5.0
    """Training time of each variant, of one processor."""
    variants: tuple[str, ...] = tuple(VARIANTS)
    """Which to run."""
    json: Path | None = None
    """Where to write the figures."""
    sampler: SamplerConfig = field(default_factory=SamplerConfig)
    protocol: Protocol = field(default_factory=lambda: Protocol(repeats=2))


def main() -> None:
    """Train, measure and print the tables."""
    options = tyro.cli(Options)
    keep_freed_memory()
    torch.set_num_threads(1)
    corpus, minilm = Corpus.load(options.corpus), load_text_encoder("minilm")
    evaluator = Evaluator.from_pretrained(shipped_evaluator(), minilm)
    rows: list[Row] = []
    windows: dict[str, int] = {}
    for name in options.variants:
        encoder = UntrainedWords() if VARIANTS[name].text_encoder == UNTRAINED else minilm
        folder = options.out / name.partition(":")[0].replace(" ", "-")
        windows[name] = _train(corpus, encoder, VARIANTS[name], folder, options.minutes)
        pipeline = MotionPipeline(Checkpoint.from_pretrained(folder / CHECKPOINT_FOLDER), encoder)
        source = Model(pipeline, options.sampler)
        found = evaluate_texts(corpus, "val", evaluator, [source], options.protocol)
        if not rows:
            rows += [row for row in found if row.name != "generated"]
        rows += [replace(row, name=name) for row in found if row.name == "generated"]
        Console().print(terminal_table(metrics_cells(rows), f"{options.minutes:g} min each"))
    Console().print(terminal_table(plausibility_cells(rows), "physics, before repair"))
    print({name: f"{count} windows" for name, count in windows.items()})
    if options.json is not None:
        result = {
            "minutes": options.minutes,
            "sampler": vars(options.sampler),
            "protocol": options.protocol.to_dict(),
            "evaluator_sha256": evaluator.sha256,
            "windows": windows,
            "rows": rows_to_json(rows),
        }
        options.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


def _train(
    corpus: Corpus, encoder: TextEncoder, denoiser: DenoiserConfig, folder: Path, minutes: float
) -> int:
    """Return the number of windows seen."""
    # a short horizon of the average: it must not hold the first steps of so short a run
    config = TrainConfig(minutes=minutes, warmup_steps=20, ema_decay=0.98, validate_steps=10**6)
    if not (folder / CHECKPOINT_FOLDER).exists():
        Trainer(corpus, encoder, denoiser, config, folder, clock=time.process_time).run()
    last = json.loads((folder / "log.jsonl").read_text().splitlines()[-1])
    return last["step"] * config.batch_size


if __name__ == "__main__":
    main()
