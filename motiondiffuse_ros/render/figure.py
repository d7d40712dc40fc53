"""The drawn body: what a frame of a motion looks like as tapered capsules on a floor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import ImageColor, ImageDraw

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.motion.rotations import Array

LEFT, RIGHT, TRUNK = "#2a78d6", "#eb6834", "#4a5261"
GRID, PATH, SHADOW = "#d9dde2", "#8a94a3", "#cdd3da"

# Points the skeleton lacks: (name, joint whose frame it moves with, offset [m]).
_TIPS: tuple[tuple[str, str, tuple[float, float, float]], ...] = (
    ("left_heel", "left_ankle", (-0.06, 0.0, -0.045)),
    ("right_heel", "right_ankle", (-0.06, 0.0, -0.045)),
    ("left_toe_tip", "left_foot", (0.07, 0.0, 0.005)),
    ("right_toe_tip", "right_foot", (0.07, 0.0, 0.005)),
    ("left_hand", "left_wrist", (0.0, 0.13, 0.0)),
    ("right_hand", "right_wrist", (0.0, -0.13, 0.0)),
    ("crown", "head", (0.02, 0.0, 0.13)),
    ("brow", "head", (0.02, 0.0, 0.07)),
)
# (from, to, radius at from, radius at to) [m]
_Bone = tuple[int, int, float, float]
_TRUNK_BONES = (
    ("left_hip", "right_hip", 0.085, 0.085),
    ("pelvis", "spine2", 0.105, 0.10),
    ("spine2", "neck", 0.11, 0.075),
    ("left_shoulder", "right_shoulder", 0.06, 0.06),
    ("neck", "head", 0.048, 0.05),
)
_HEAD_BONES = (("brow", "crown", 0.088, 0.082),)
_SIDE_BONES = (
    ("hip", "knee", 0.078, 0.054),
    ("knee", "ankle", 0.054, 0.036),
    ("heel", "foot", 0.034, 0.026),
    ("ankle", "foot", 0.036, 0.026),
    ("foot", "toe_tip", 0.026, 0.018),
    ("shoulder", "elbow", 0.05, 0.038),
    ("elbow", "wrist", 0.038, 0.026),
    ("wrist", "hand", 0.028, 0.03),
)
_POINTS = (*CANONICAL.names, *(name for name, _, _ in _TIPS))


def _shapes(prefix: str, bones: tuple[tuple[str, str, float, float], ...]) -> list[_Bone]:
    return [
        (_POINTS.index(prefix + a), _POINTS.index(prefix + b), ra, rb) for a, b, ra, rb in bones
    ]


# Bones that are drawn together, without a seam between them, and their colour.
_GROUPS: tuple[tuple[list[_Bone], str], ...] = (
    (_shapes("", _TRUNK_BONES), TRUNK),
    (_shapes("", _HEAD_BONES), TRUNK),
    *(([bone], LEFT) for bone in _shapes("left_", _SIDE_BONES)),
    *(([bone], RIGHT) for bone in _shapes("right_", _SIDE_BONES)),
)


def body_points(motion: Motion) -> Array:
    """Return the joints and the drawn tips (heels, toes, hands, head) [T, P, 3], m."""
    tips = [
        motion.positions[:, j] + rot.rotate(motion.global_rotations[:, j], np.array(offset))
        for j, offset in ((CANONICAL.index(joint), offset) for _, joint, offset in _TIPS)
    ]
    return np.concatenate([motion.positions, np.stack(tips, axis=1)], axis=1)


@dataclass(frozen=True)
class Camera:
    """An orthographic camera that looks at a point on the floor.

    Attributes:
        centre: What is at `origin` on the picture [x, y, z], m.
        origin: Pixel of `centre`.
        scale: Pixels a metre.
        azimuth: Direction from the centre to the camera about z, 0 along +x, rad.
        elevation: Of the camera above the horizon, rad.
    """

    centre: tuple[float, float, float]
    origin: tuple[float, float]
    scale: float
    azimuth: float = -0.85
    elevation: float = 0.26

    def project(self, points: Array) -> tuple[Array, Array]:
        """Return pixels [..., 2] and depths [...] (greater is nearer to the camera), m."""
        sa, ca = np.sin(self.azimuth), np.cos(self.azimuth)
        se, ce = np.sin(self.elevation), np.cos(self.elevation)
        axes = np.array([[-sa, ca, 0.0], [se * ca, se * sa, -ce], [ce * ca, ce * sa, se]])
        view = (points - np.array(self.centre)) @ axes.T
        return np.array(self.origin) + self.scale * view[..., :2], view[..., 2]


def draw_floor(draw: ImageDraw.ImageDraw, camera: Camera, radius: float, step: float = 0.5) -> None:
    """Draw the lines of a world-fixed grid inside a disc around the camera's centre."""
    cx, cy = camera.centre[:2]
    width = max(1, round(camera.scale * 0.006))
    for axis, (along, across) in enumerate(((cx, cy), (cy, cx))):
        first, last = np.ceil((across - radius) / step), np.floor((across + radius) / step)
        for line in np.arange(first, last + 1) * step:
            half = np.sqrt(max(radius**2 - (line - across) ** 2, 0.0))
            ends = np.array([[along - half, line, 0.0], [along + half, line, 0.0]])
            _polyline(draw, camera, ends if axis == 0 else ends[:, [1, 0, 2]], GRID, width)


def draw_path(draw: ImageDraw.ImageDraw, camera: Camera, path: Array) -> None:
    """Draw where the root has been [N, 2 or 3] as a line on the floor."""
    if len(path) > 1:
        flat = np.column_stack([path[:, :2], np.zeros(len(path))])
        _polyline(draw, camera, flat, PATH, max(1, round(camera.scale * 0.014)))


def draw_body(draw: ImageDraw.ImageDraw, camera: Camera, points: Array) -> None:
    """Draw one frame of `body_points` [P, 3]: far limbs first and paler, shadow on the floor."""
    _draw_shadow(draw, camera, points)
    pixels, depths = camera.project(points)
    front = depths[0] + 0.25
    edge = max(1.0, 0.011 * camera.scale)

    def nearness(group: tuple[list[_Bone], str]) -> float:
        return float(np.mean([depths[[a, b]] for a, b, _, _ in group[0]]))

    for group in sorted(_GROUPS, key=nearness):
        fill = _mix(group[1], "#ffffff", float(np.clip(0.5 * (front - nearness(group)), 0, 0.4)))
        for grow, colour in ((edge, "#ffffff"), (0.0, fill)):
            for a, b, ra, rb in group[0]:
                radii = (ra * camera.scale + grow, rb * camera.scale + grow)
                _capsule(draw, pixels[a], pixels[b], radii, colour)


def _draw_shadow(draw: ImageDraw.ImageDraw, camera: Camera, points: Array) -> None:
    for a, b, ra, rb in (bone for group, _ in _GROUPS for bone in group):
        ends, _ = camera.project(points[[a, b]] * [1.0, 1.0, 0.0])
        # a floor disc is seen foreshortened: half its radius looks right at this elevation
        radii = (0.5 * ra * camera.scale, 0.5 * rb * camera.scale)
        _capsule(draw, ends[0], ends[1], radii, SHADOW)


def _polyline(
    draw: ImageDraw.ImageDraw, camera: Camera, points: Array, colour: str, width: int
) -> None:
    pixels, _ = camera.project(points)
    draw.line([(float(x), float(y)) for x, y in pixels], fill=colour, width=width, joint="curve")


def _capsule(
    draw: ImageDraw.ImageDraw, a: Array, b: Array, radii: tuple[float, float], fill: str
) -> None:
    along = b - a
    length = float(np.hypot(*along))
    if length > 1e-6:
        normal = np.array([-along[1], along[0]]) / length
        corners = (a + normal * radii[0], b + normal * radii[1])
        mirrored = (b - normal * radii[1], a - normal * radii[0])
        draw.polygon([(float(x), float(y)) for x, y in (*corners, *mirrored)], fill=fill)
    for (x, y), r in ((a, radii[0]), (b, radii[1])):
        draw.ellipse([float(x - r), float(y - r), float(x + r), float(y + r)], fill=fill)


def _mix(colour: str, other: str, share: float) -> str:
    mixed = [
        round(a * (1 - share) + b * share)
        for a, b in zip(ImageColor.getrgb(colour), ImageColor.getrgb(other), strict=True)
    ]
    return "#{:02x}{:02x}{:02x}".format(*mixed[:3])
