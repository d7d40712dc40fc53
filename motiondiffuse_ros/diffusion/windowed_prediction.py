"""One prediction for a whole timeline from the predictions of its windows (eq. 10 and eq. 11)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from motiondiffuse_ros.diffusion.composition import Window
from motiondiffuse_ros.diffusion.imagination import Imagination

BATCH_ROWS = 16
"""Windows that are denoised at once: more take no less time each."""


Predictor = Callable[[Tensor, int, Tensor, Tensor], Tensor]
"""The denoiser under guidance: noisy features [B, T, D], step, lengths [B] and the windows whose
texts they are for [B], to the prediction [B, T, D]."""


@dataclass(frozen=True, eq=False)
class _Pull:
    """How strongly two windows' predictions are drawn together over the frames they share."""

    one: int
    other: int
    start: int
    stop: int
    strength: Tensor
    """[frames, 1]"""
    in_time: bool
    """Whether the windows are neighbours in time of the same parts."""


class WindowedPrediction:
    """The weighted sum over windows, after a step that draws their predictions together.

    The paper's correction terms leave open what their gradient is taken of. Here each window's
    prediction goes down the gradient of half the squared distances to the predictions of windows
    that share its frames, before it is weighted: with a step of one, windows that are fully there
    meet at their mean. Texts on other parts are drawn by λ₁ (eq. 10), neighbours in time of the
    same parts by λ₂ (eq. 11). Predictions of noise, clean features and velocity differ by factors
    that all windows share, so the step means the same for each.
    """

    def __init__(
        self,
        predict: Predictor,
        windows: Sequence[Window],
        *,
        part_correction: float,
        time_correction: float,
        device: torch.device,
        text_of: Sequence[int] | None = None,
    ) -> None:
        """Lay out batches.

        Args:
            predict: The denoiser.
            windows: Of the timeline; their weights sum to one.
            part_correction: λ₁, 0 to 1.
            time_correction: λ₂, 0 to 1.
            device: Of the noisy features.
            text_of: Which of the predictor's texts each window has; one each if None.
        """
        self._predict, self._windows = predict, windows
        self._text_of = range(len(windows)) if text_of is None else text_of
        self._weights = [
            torch.from_numpy(np.ascontiguousarray(w.weight, dtype=np.float32)).to(device)
            for w in windows
        ]
        self._pulls = _pulls(windows, part_correction, time_correction, device)

    def _laid_out(self, candidates: int) -> list[list[tuple[int, int]]]:
        rows = [(w, c) for w in range(len(self._windows)) for c in range(candidates)]
        # windows of like length share a batch
        rows.sort(key=lambda row: len(self._weights[row[0]]))
        return [rows[i : i + BATCH_ROWS] for i in range(0, len(rows), BATCH_ROWS)]

    def __call__(self, x: Tensor, step: int, imagination: Imagination | None = None) -> Tensor:
        """Return the prediction [C, T, D].

        Args:
            x: Noisy features of C candidates [C, T, D].
            step: Diffusion step.
            imagination: Of their windows, where they are denoised apart at first; λ₁ counts from
                where they no longer are.
        """
        added = None if imagination is None else imagination.at(step)
        pulls = [pull for pull in self._pulls if added is None or pull.in_time]
        out = torch.zeros_like(x)
        if added is None and not pulls:  # no window needs another's prediction
            for w, c, prediction in self._of_rows(x, step, None):
                window = self._windows[w]
                out[c, window.start : window.stop] += self._weights[w] * prediction
            return out
        predictions = [x.new_empty((len(x), len(w), x.shape[2])) for w in self._weights]
        for w, c, prediction in self._of_rows(x, step, added):
            predictions[w][c] = prediction
        for w, window in enumerate(self._windows):
            out[:, window.start : window.stop] += self._weights[w] * predictions[w]
        for pull in pulls:
            a, b = (
                slice(pull.start - self._windows[w].start, pull.stop - self._windows[w].start)
                for w in (pull.one, pull.other)
            )
            apart = predictions[pull.other][:, b] - predictions[pull.one][:, a]
            lead = self._weights[pull.one][a] - self._weights[pull.other][b]
            out[:, pull.start : pull.stop] += lead * (pull.strength * apart)
        if imagination is not None and added is not None:
            imagination.learn(step, added, predictions, out)
        return out

    def _of_rows(
        self, x: Tensor, step: int, added: Sequence[Tensor | None] | None
    ) -> Iterator[tuple[int, int, Tensor]]:
        """Yield window, candidate and prediction [frames, D] of each; see `Imagination.at`."""
        for batch in self._laid_out(len(x)):
            texts = torch.tensor([self._text_of[w] for w, _ in batch])
            lengths = torch.tensor([len(self._weights[w]) for w, _ in batch], device=x.device)
            noisy = x.new_zeros((len(batch), int(lengths.max()), x.shape[2]))
            for row, (w, c) in zip(noisy, batch, strict=True):
                window = self._windows[w]
                row[: len(self._weights[w])] = x[c, window.start : window.stop]
                own = None if added is None else added[w]
                if own is not None:
                    row[: len(self._weights[w])] += own[c]
            prediction = self._predict(noisy, step, lengths, texts)
            for row, (w, c) in zip(prediction, batch, strict=True):
                yield w, c, row[: len(self._weights[w])]


def _pulls(
    windows: Sequence[Window],
    part_correction: float,
    time_correction: float,
    device: torch.device,
) -> list[_Pull]:
    if part_correction == time_correction == 0.0:
        return []
    # a window is there as far as its greatest weight says: pulls fade with the ramps, or the
    # correction itself would make a seam where a window begins
    presence = [w.weight.max(axis=1) for w in windows]
    frames = max((w.stop for w in windows), default=0)
    total = np.zeros(frames)
    for window, p in zip(windows, presence, strict=True):
        total[window.start : window.stop] += p
    pulls = []
    for a, b in _meeting(windows):
        one, other = windows[a], windows[b]
        start, stop = max(one.start, other.start), min(one.stop, other.stop)
        in_time = one.parts == other.parts
        amount = time_correction if in_time else part_correction
        if start >= stop or amount == 0.0:
            continue
        p = presence[a][start - one.start : stop - one.start]
        q = presence[b][start - other.start : stop - other.start]
        strength = amount * p * q / np.maximum(total[start:stop], 1.0)
        column = torch.from_numpy(strength[:, None].astype(np.float32)).to(device)
        pulls.append(_Pull(a, b, start, stop, column, in_time))
    return pulls


def _meeting(windows: Sequence[Window]) -> Iterator[tuple[int, int]]:
    """Yield the pairs of windows that share frames, in time linear in their count."""
    open_windows: list[int] = []
    for b in sorted(range(len(windows)), key=lambda w: windows[w].start):
        open_windows = [a for a in open_windows if windows[a].stop > windows[b].start]
        yield from ((min(a, b), max(a, b)) for a in open_windows)
        open_windows.append(b)
