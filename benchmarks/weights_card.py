"""Ship a training run: copy its checkpoint and draw its curves.

    python -m benchmarks.weights_card --run runs/base --out motiondiffuse_ros/weights/base

Writes the checkpoint's files, training.json (settings, steps, minutes, last losses) and
curves.png. A run that started from the weights that are there counts on from theirs, and may be
averaged with them (Wortsman et al. 2022). The model card and licence beside them are written by
hand.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import tyro

matplotlib.use("agg")
from matplotlib import pyplot as plt

from motiondiffuse_ros.diffusion.checkpoint import Checkpoint


@dataclass(frozen=True)
class Options:
    """What to ship."""

    run: Path
    """Folder of the run."""
    out: Path
    """Folder of the weights."""
    share: float = 1.0
    """Of the run's weights; the rest is of those that are in `out`, from which it started."""


def main() -> None:
    """Copy, summarise and draw."""
    options = tyro.cli(Options)
    checkpoint = Checkpoint.from_pretrained(options.run / "checkpoint")
    options.out.mkdir(parents=True, exist_ok=True)
    settings = json.loads((options.run / "config.json").read_text())
    earlier = _earlier(options.out, settings["started_from"])
    if options.share < 1.0 and not earlier:
        raise SystemExit(f"{options.out} does not hold the weights that {options.run} started from")
    average = _average(options.out, checkpoint, options.share) if options.share < 1.0 else None
    shutil.copytree(options.run / "checkpoint", options.out, dirs_exist_ok=True)
    if average is not None:
        average.save_pretrained(options.out)
    rows = [json.loads(line) for line in (options.run / "log.jsonl").read_text().splitlines()]
    training = [row for row in rows if "plain" in row]
    validation = [row for row in rows if "validation" in row]
    own = {
        "steps": rows[-1]["step"],
        "minutes": rows[-1]["minutes"],
        "windows": rows[-1]["step"] * settings["training"]["batch_size"],
    }
    summary = {
        **settings,
        **{name: count + earlier.get(name, 0) for name, count in own.items()},
        "training_loss_plain": float(np.mean([row["plain"] for row in training[-20:]])),
        "validation_loss_plain": validation[-1]["validation"],
        "share": options.share,
        "run_sha256": checkpoint.sha256,
        "model_sha256": Checkpoint.from_pretrained(options.out).sha256,
    }
    (options.out / "training.json").write_text(json.dumps(summary, indent=2) + "\n")
    _draw(training, validation, options.out / "curves.png")
    print(json.dumps({k: v for k, v in summary.items() if k not in ("training", "denoiser")}))


def _average(before: Path, after: Checkpoint, share: float) -> Checkpoint:
    """Return the weights in `before`, moved by a share of the way to those of `after`."""
    average, aim = Checkpoint.from_pretrained(before), after.denoiser.state_dict()
    weights = average.denoiser.state_dict()
    average.denoiser.load_state_dict(
        {name: (1.0 - share) * w + share * aim[name] for name, w in weights.items()}
    )
    return average


def _earlier(out: Path, started_from: str | None) -> dict:
    """Return the training.json of the weights that a run started from, if they are in `out`."""
    card = out / "training.json"
    there = json.loads(card.read_text()) if started_from and card.exists() else {}
    return there if there.get("model_sha256") == started_from else {}


def _draw(training: list[dict], validation: list[dict], path: Path) -> None:
    figure, axes = plt.subplots(figsize=(7.0, 3.6), layout="constrained")
    minutes = [row["minutes"] for row in training]
    axes.plot(minutes, [row["plain"] for row in training], lw=0.7, alpha=0.6, label="training")
    axes.plot(
        [row["minutes"] for row in validation],
        [row["validation"] for row in validation],
        "o-",
        label="held-out clips, averaged weights",
    )
    axes.set(xlabel="minutes", ylabel="mean squared error of clean features", ylim=(0.15, 1.2))
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
