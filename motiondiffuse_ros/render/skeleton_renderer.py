"""Motions as pictures with Pillow alone: animated GIFs and contact sheets."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.render.figure import Camera, body_points, draw_body, draw_floor, draw_path

_SUPERSAMPLING = 3
_INK, _MUTED, _PAPER = "#20262e", "#7b8591", "#ffffff"
_PANEL = (230, 260)
_SHEET_PANEL = (124, 150)
_FLOOR_RADIUS = 0.75


def render_skeleton(
    motions: Sequence[Motion],
    path: Path,
    *,
    titles: Sequence[str] = (),
    fps: float = 20.0,
) -> Path:
    """Animate motions side by side, the camera of each following its root.

    Args:
        motions: One or more; a shorter one holds its last frame.
        path: Where the GIF goes; its folder is created.
        titles: A caption for each motion, or none.
        fps: Frames per second of the GIF, at most 50 (what players honour).

    Returns:
        The path.

    Raises:
        ValueError: If there are no motions, or titles that are not as many.
    """
    if not motions or (titles and len(titles) != len(motions)):
        raise ValueError(f"got {len(motions)} motions and {len(titles)} titles")
    fps = min(fps, 50.0)
    resampled = [motion.resample(fps) for motion in motions]
    points = [body_points(motion) for motion in resampled]
    frames = max(len(p) for p in points)
    labels = list(titles) or [""] * len(points)
    pictures = [_animation_frame(points, labels, index, index / fps) for index in range(frames)]
    return save_gif(pictures, path, fps)


def contact_sheet(rows: Sequence[tuple[str, Motion]], path: Path, *, columns: int = 8) -> Path:
    """Draw one row a motion: its caption and poses evenly spaced from the first to the last.

    The grid on the floor has cells of 0.5 m and is fixed in the world, the grey line is where
    the root has been, left limbs are blue and right ones orange.

    Args:
        rows: Captions and motions.
        path: Where the PNG goes; its folder is created.
        columns: Poses a row.

    Returns:
        The path.

    Raises:
        ValueError: If there are no rows or columns.
    """
    if not rows or columns < 1:
        raise ValueError(f"a sheet needs rows and columns, got {len(rows)} and {columns}")
    s = _SUPERSAMPLING
    width, height, caption = _SHEET_PANEL[0], _SHEET_PANEL[1], 26
    size = (columns * width * s, len(rows) * (height + caption) * s)
    picture = Image.new("RGB", size, _PAPER)
    draw = ImageDraw.Draw(picture)
    for row, (text, motion) in enumerate(rows):
        top = row * (height + caption) * s
        if row:
            draw.line([(0, top), (size[0], top)], fill="#e8ebee", width=s)
        _write_caption(draw, text, motion, (size[0], top))
        points = body_points(motion)
        # a jump or a climb must not leave its panel: the whole row takes one scale
        tall = max(1.75, float(points[..., 2].max()) + 0.05)
        scale = 0.80 * height * s / tall
        for column, frame in enumerate(_evenly(motion.frames, columns)):
            origin = ((column + 0.5) * width * s, top + (caption + height * 0.86) * s)
            _draw_pose(draw, points, motion.root, frame, origin, scale)
            label = f"{frame / motion.fps:.1f} s"
            spot = (origin[0], top + (caption + height - 7) * s)
            draw.text(spot, label, fill=_MUTED, font=_font(10 * s), anchor="mm")
    path.parent.mkdir(parents=True, exist_ok=True)
    picture.resize((size[0] // s, size[1] // s), Image.Resampling.LANCZOS).save(path, optimize=True)
    return path


def save_gif(pictures: Sequence[Image.Image], path: Path, fps: float) -> Path:
    """Write a looping GIF with one palette for all frames, so that nothing flickers."""
    # the palette is made from the first, a middle and the last frame together
    picks = [pictures[i] for i in sorted({0, len(pictures) // 2, len(pictures) - 1})]
    strip = Image.new("RGB", (picks[0].width * len(picks), picks[0].height))
    for i, pick in enumerate(picks):
        strip.paste(pick.convert("RGB"), (i * pick.width, 0))
    palette = strip.quantize(128)
    frames = [
        p.convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE) for p in pictures
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    frames[0].save(
        path,
        save_all=True,
        append_images=frames[1:],
        duration=max(20, round(1000 / fps)),
        loop=0,
        optimize=False,
    )
    return path


def _animation_frame(
    points: Sequence[np.ndarray], titles: Sequence[str], index: int, time: float
) -> Image.Image:
    s = _SUPERSAMPLING - 1
    width, height = _PANEL
    picture = Image.new("RGB", (len(points) * width * s, height * s), _PAPER)
    draw = ImageDraw.Draw(picture)
    for column, (body, title) in enumerate(zip(points, titles, strict=True)):
        origin = ((column + 0.5) * width * s, 0.88 * height * s)
        tall = max(1.9, float(body[..., 2].max()) + 0.1)
        frame = min(index, len(body) - 1)
        _draw_pose(draw, body, body[:, 0], frame, origin, 0.78 * height * s / tall)
        spot = ((column + 0.5) * width * s, 12 * s)
        text = _fitted(title, _font(11 * s), (width - 12) * s)
        draw.text(spot, text, fill=_INK, font=_font(11 * s), anchor="mm")
    clock = (picture.width - 6 * s, picture.height - 8 * s)
    draw.text(clock, f"{time:.1f} s", fill=_MUTED, font=_font(10 * s), anchor="rm")
    return picture.resize((picture.width // s, picture.height // s), Image.Resampling.LANCZOS)


def _draw_pose(
    draw: ImageDraw.ImageDraw,
    points: np.ndarray,
    root: np.ndarray,
    frame: int,
    origin: tuple[float, float],
    scale: float,
) -> None:
    x, y = root[frame, :2]
    camera = Camera((float(x), float(y), 0.0), origin, scale)
    draw_floor(draw, camera, _FLOOR_RADIUS)
    trail = root[: frame + 1]
    near = np.hypot(*(trail[:, :2] - root[frame, :2]).T) < _FLOOR_RADIUS
    # only the unbroken stretch that leads to this frame
    start = len(near) - int(np.argmin(near[::-1])) if not near.all() else 0
    draw_path(draw, camera, trail[start:])
    draw_body(draw, camera, points[frame])


def _write_caption(
    draw: ImageDraw.ImageDraw, text: str, motion: Motion, corner: tuple[int, int]
) -> None:
    s = _SUPERSAMPLING
    right, top = corner
    y = top + 14 * s
    draw.text((right - 8 * s, y), _travel(motion), fill=_MUTED, font=_font(11 * s), anchor="rm")
    text = _fitted(text, _font(13 * s), right - 190 * s)
    draw.text((10 * s, y), text, fill=_INK, font=_font(13 * s), anchor="lm")


def _travel(motion: Motion) -> str:
    way = motion.root[-1] - motion.root[0]
    return f"{motion.duration:.1f} s   moved {np.hypot(way[0], way[1]):.1f} m"


def _evenly(frames: int, count: int) -> list[int]:
    return [round(i) for i in np.linspace(0, frames - 1, count)]


def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)


def _fitted(text: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, width: float) -> str:
    if font.getlength(text) <= width:
        return text
    while text and font.getlength(text + "…") > width:
        text = text[:-1]
    return text.rstrip() + "…"
