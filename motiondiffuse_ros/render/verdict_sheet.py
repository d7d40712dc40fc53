"""The picture of a verdict: contacts, errors and balance over time, with what fails marked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.criteria import CRITERIA
from motiondiffuse_ros.physics.measures import RATE, Series
from motiondiffuse_ros.physics.report import IMPLAUSIBLE, PLAUSIBLE, Report
from motiondiffuse_ros.render.figure import GRID, LEFT, RIGHT, TRUNK

_WIDTH, _MARGIN, _NAMES = 1200, 24, 190
_ROW, _GAP, _LINE = 64, 14, 22
_BACKGROUND, _PALE, _FAIL, _FAIL_LINE = "#ffffff", "#6b7482", "#f9d5d0", "#c8321f"
_VERDICT = {PLAUSIBLE: "#23863a", IMPLAUSIBLE: _FAIL_LINE}
_UNSURE = "#b77a00"


@dataclass(frozen=True)
class _Row:
    """One curve.

    Attributes:
        series: Name of the series above the axis.
        title: What stands beside it, with its unit.
        least: Smallest value at the top of the row.
        below: Series that is drawn downwards from the axis, if any.
    """

    series: str
    title: str
    least: float
    below: str | None = None


_ROWS = (
    _Row("float", "floats / penetrates, mm", 30.0, below="penetrate"),
    _Row("support_slide", "support slides, m/s", 0.5),
    _Row("residual_force", "carried by nothing, weights", 1.0),
    _Row("residual_torque", "out of balance, weights m", 0.3),
    _Row("next_step", "beyond next step, mm", 200.0),
    _Row("torque_excess", "torque over limit, N m", 100.0),
    _Row("jerk", "jerk, m/s^3", 2000.0),
)
_MARKS = {c.shown: c.span_above for c in reversed(CRITERIA)}


def draw_verdict(report: Report, path: Path, title: str = "") -> None:
    """Write a picture of a report that carries its series.

    Args:
        report: Of `assess` or `assess_states`; without series only its words are drawn.
        path: An image file; its suffix says of which kind.
        title: Over the picture.
    """
    verdict_sheet(report, title).save(path)


def verdict_sheet(report: Report, title: str = "") -> Image.Image:
    """Return the picture."""
    words = [_shortened(reason) for reason in report.reasons]
    head = _MARGIN + 34 + _LINE * len(words) + _GAP
    contacts = [name for name in report.series if name.startswith("contact_")]
    rows = [row for row in _ROWS if row.series in report.series]
    height = head + (_LINE + 4) * len(contacts) + (_ROW + _GAP) * len(rows) + 60
    image = Image.new("RGB", (_WIDTH, height), _BACKGROUND)
    draw = ImageDraw.Draw(image)
    colour = _VERDICT.get(report.verdict, _UNSURE)
    says = f"{title}  {report.verdict}, score {report.score:.2f}".strip()
    draw.text((_MARGIN, _MARGIN), says, colour, font=_font(22))
    for n, line in enumerate(words):
        draw.text((_MARGIN, _MARGIN + 34 + n * _LINE), line, TRUNK, font=_font(15))
    if not report.series:
        return image
    y = head
    for name in contacts:
        _draw_contact(draw, y, name, report.series[name].values)
        y += _LINE + 4
    y += _GAP // 2
    for row in rows:
        _draw_row(draw, y, row, report.series)
        y += _ROW + _GAP
    _draw_time(draw, head, y, len(next(iter(report.series.values())).values))
    return image


def _draw_contact(draw: ImageDraw.ImageDraw, y: int, name: str, values: Array) -> None:
    side = name.removeprefix("contact_").replace("_", " ")
    draw.text((_MARGIN, y), f"{side} on floor", TRUNK, font=_font(14))
    x = _columns(len(values) + 1)
    colour = RIGHT if "right" in side else LEFT
    for n in np.flatnonzero(values > 0.0):
        draw.rectangle((x[n], y + 3, x[n + 1], y + 15), fill=colour)


def _draw_row(draw: ImageDraw.ImageDraw, y: int, row: _Row, series: Mapping[str, Series]) -> None:
    above = np.nan_to_num(series[row.series].values)
    below = None if row.below is None else np.nan_to_num(series[row.below].values)
    x = _columns(len(above) + 1)
    failing = above > _MARKS.get(row.series, np.inf)
    if row.below is not None and below is not None:
        failing |= below > _MARKS.get(row.below, np.inf)
    for n in np.flatnonzero(failing):
        draw.rectangle((x[n], y, x[n + 1], y + _ROW), fill=_FAIL)
    axis = y + _ROW // 2 if row.below else y + _ROW
    size = _ROW // 2 if row.below else _ROW
    largest = max(row.least, float(above.max()), 0.0 if below is None else float(below.max()))
    draw.text((_MARGIN, y + 6), row.title, TRUNK, font=_font(14))
    draw.text((_MARGIN, y + 26), f"up to {largest:.3g}", _PALE, font=_font(13))
    draw.line((x[0], axis, x[-1], axis), GRID, 1)
    if (mark := _MARKS.get(row.series)) is not None and mark > 0.0:
        level = axis - size * mark / largest
        draw.line((x[0], level, x[-1], level), "#e8b4ad", 1)
    middle = (x[1:] + x[:-1]) / 2.0
    for values, sign, colour in ((above, -1.0, LEFT), (below, 1.0, _FAIL_LINE)):
        if values is not None:
            points = np.stack([middle, axis + sign * size * values / largest], axis=-1)
            draw.line([tuple(p) for p in points], colour, 2)


def _draw_time(draw: ImageDraw.ImageDraw, top: int, bottom: int, frames: int) -> None:
    x = _columns(frames + 1)
    seconds = frames / RATE
    every = 1.0 if seconds <= 15.0 else 5.0
    for time in np.arange(0.0, seconds + 1e-6, every):
        at = x[0] + (x[-1] - x[0]) * time / seconds
        for y in range(top, bottom, 6):
            draw.point((at, y), _PALE)
        draw.text((at - 8, bottom), f"{time:.0f} s", _PALE, font=_font(13))


def _columns(count: int) -> Array:
    return np.linspace(_MARGIN + _NAMES, _WIDTH - _MARGIN, count)


def _shortened(words: str, most: int = 150) -> str:
    return words if len(words) <= most else f"{words[: most - 1]}…"


def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)
