"""What each of two processes does in `test_ranks.py`; started by it."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import torch
import torch.distributed as dist
from made_corpus import corpus_of
from small_denoiser import SMALL
from synthetic import standing, waving

from motiondiffuse_ros.corpus.store import Corpus
from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.errors import Cancelled
from motiondiffuse_ros.text import TokenStates, load_text_encoder
from motiondiffuse_ros.training.config import TrainConfig
from motiondiffuse_ros.training.ranks import Ranks
from motiondiffuse_ros.training.text_to_prediction import TextToPrediction
from motiondiffuse_ros.training.trainer import STATE_FILE, Trainer

# the clocks of these trainers tick once a question: minutes are a number of steps
SECOND = 1.0 / 60.0
CONFIG = TrainConfig(
    minutes=0.5 * SECOND,
    batch_size=4,
    validate_steps=2,
    warmup_steps=1,
    precision="fp32",
)


class KeptStates:
    """A text encoder whose answers are kept, since every trainer asks for the same texts."""

    def __init__(self) -> None:
        encoder = load_text_encoder("minilm")
        self.name, self.dim, self.sha256 = encoder.name, encoder.dim, encoder.sha256
        self._encode = cache(encoder.encode)

    def encode(self, texts: Sequence[str]) -> TokenStates:
        """Return the states of sentences."""
        return self._encode(tuple(texts))


@cache
def _encoder() -> KeptStates:
    return KeptStates()


def small_corpus() -> Corpus:
    """Return few made clips of the same length."""
    texts = {"a person stands": standing(40), "a person waves with the right hand": waving(40)}
    return corpus_of(
        [
            (f"{split}_{i}", split, text, motion)
            for split in ("train", "val")
            for i, (text, motion) in enumerate(texts.items())
        ]
    )


def small_trainer(out: Path, ranks: Ranks, *, tick: float = 1.0, resume=False, **settings):
    """Return a trainer on the small corpus."""
    return Trainer(
        small_corpus(),
        _encoder(),
        SMALL,
        replace(CONFIG, **settings),
        out,
        resume=resume,
        ranks=ranks,
        clock=itertools.count(0.0, tick).__next__,
    )


def gradients(trainer: Trainer) -> dict[str, torch.Tensor]:
    """Return the gradients of the last step, before they were clipped."""
    return {n: p.grad.clone() for n, p in trainer.denoiser.named_parameters() if p.grad is not None}


def joint_batch(denoiser) -> tuple[TokenStates, tuple[torch.Tensor, ...], torch.Tensor]:
    """Return texts, (noisy, steps, lengths) and targets of four windows."""
    generator = torch.Generator().manual_seed(5)
    rows, config = 4, denoiser.config
    states = torch.randn(rows, 6, config.text_dim, generator=generator)
    noisy = torch.randn(rows, 16, config.feature_dim, generator=generator)
    target = torch.randn(noisy.shape, generator=generator)
    steps = torch.tensor([3, 300, 700, 999])
    tokens = TokenStates(states, torch.ones(rows, 6, dtype=torch.bool))
    return tokens, (noisy, steps, torch.full((rows,), 16)), target


def gradient_of_rows(ranks: Ranks, rows: slice) -> dict[str, torch.Tensor]:
    """Return the gradient of the mean squared error of some rows of the joint batch."""
    torch.manual_seed(0)
    denoiser = Denoiser(replace(SMALL, dropout=0.0))
    for p in denoiser.parameters():  # not one of zeros, which hide others' gradients
        torch.nn.init.normal_(p, std=0.05)
    tokens, inputs, target = joint_batch(denoiser)
    model = ranks.together(TextToPrediction(denoiser))
    output, pooled = model(
        TokenStates(tokens.states[rows], tokens.mask[rows]), *(x[rows] for x in inputs)
    )
    ((output - target[rows]).square().mean() + pooled.square().mean()).backward()
    return {n: p.grad for n, p in denoiser.named_parameters() if p.grad is not None}


def main() -> None:
    """Run as one of two processes: RANK ADDRESS-FILE FOLDER."""
    rank, meeting, folder = int(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    torch.set_num_threads(1)
    dist.init_process_group("gloo", init_method=f"file://{meeting}", rank=rank, world_size=2)
    ranks, found = Ranks(rank, 2), {}

    found["rows"] = gradient_of_rows(ranks, slice(2 * rank, 2 * rank + 2))

    one = small_trainer(folder / "one", ranks, gradient_clip=1e9)
    one.run()
    found["gradients"] = gradients(one)

    # the second process's clock is three times as fast: it runs out first
    run = small_trainer(folder / "run", ranks, tick=1.0 + 2.0 * rank, minutes=20 * SECOND)
    run.run()
    found["weights"] = dict(run.denoiser.state_dict())
    found["saved"] = torch.load(folder / "run" / STATE_FILE, weights_only=True)["step"]

    # resumed by both, and stopped in the second process alone
    again = small_trainer(folder / "run", ranks, resume=True, minutes=1e6)
    if not ranks.first:
        again.stop()
    try:
        again.run()
    except Cancelled as stop:
        found["stop"] = str(stop)
    found["weights again"] = dict(again.denoiser.state_dict())
    torch.save(found, folder / f"{rank}.pt")
    dist.destroy_process_group()


if __name__ == "__main__":
    main()
