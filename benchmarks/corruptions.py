"""Ways to break a real motion that a judge of physics must see through."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from motiondiffuse_ros.motion import CANONICAL, Motion
from motiondiffuse_ros.motion import rotations as rot
from motiondiffuse_ros.physics.geometry import sole_probes

Corrupt = Callable[[Motion, np.random.Generator], Motion]

_LEG = ("hip", "knee", "ankle", "foot")
_IN_FLIGHT, _SHORTEST_FLIGHT = 0.04, 0.2  # m, s
_HANG = 2.5  # times longer than gravity allows
_HOP = 0.5  # s, natural duration of the hop that is put into a motion without a flight


@dataclass(frozen=True)
class Corruption:
    """One way to break a motion.

    Attributes:
        apply: Makes the broken motion; at the same rate.
        middle: Whether it is of the strength that is judged on its own.
    """

    apply: Corrupt
    middle: bool = False


def moved(motion: Motion, by: np.ndarray) -> Motion:
    """Add a displacement [3] or [T, 3], m, to the path."""
    return replace(motion, root=motion.root + by)


def lifted(height: float) -> Corrupt:
    """Raise the whole motion [m]; negative sinks it."""
    return lambda motion, _: moved(motion, np.array([0.0, 0.0, height]))


def slid(speed: float) -> Corrupt:
    """Drift in a random horizontal direction [m/s]."""

    def apply(motion: Motion, rng: np.random.Generator) -> Motion:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        times = np.arange(motion.frames)[:, None] / motion.fps
        return moved(motion, speed * times * np.array([np.cos(angle), np.sin(angle), 0.0]))

    return apply


def jittered(degrees: float, metres: float) -> Corrupt:
    """Add noise to every frame: at every joint [degrees], at the root [m]."""

    def apply(motion: Motion, rng: np.random.Generator) -> Motion:
        noise = np.radians(degrees) * rng.normal(size=(*motion.rotations.shape[:2], 3))
        rotations = rot.multiply(motion.rotations, rot.from_rotation_vector(noise))
        shaken = replace(motion, rotations=rotations)
        return moved(shaken, metres * rng.normal(size=motion.root.shape))

    return apply


def tilted(degrees: float) -> Corrupt:
    """Lean the body about the point of the floor under its root, in a random direction."""

    def apply(motion: Motion, rng: np.random.Generator) -> Motion:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        axis = np.array([np.cos(angle), np.sin(angle), 0.0])
        lean = rot.from_rotation_vector(np.radians(degrees) * axis)
        rotations = motion.rotations.copy()
        rotations[:, 0] = rot.multiply(lean, rotations[:, 0])
        height = motion.root * np.array([0.0, 0.0, 1.0])
        return moved(replace(motion, rotations=rotations), rot.rotate(lean, height) - height)

    return apply


def sped_up(factor: float) -> Corrupt:
    """Play faster."""
    return lambda motion, _: replace(motion, fps=motion.fps * factor).resample(motion.fps)


def hanging(motion: Motion, rng: np.random.Generator) -> Motion:
    """Slow the longest flight down so that it hangs in the air; where there is none, add one."""
    start, stop = _longest_flight(motion)
    if stop - start < _SHORTEST_FLIGHT * motion.fps:
        return _with_hanging_hop(motion, rng)
    extra = round((_HANG - 1.0) * (stop - start))
    flight = motion.slice(start, stop)
    slow = replace(flight, fps=flight.fps / _HANG).resample(motion.fps)
    around = [motion.slice(a, b) for a, b in ((0, start), (stop, motion.frames)) if a < b]
    parts = [*around[: start > 0], slow, *around[start > 0 :]]
    return Motion(
        np.concatenate([part.root for part in parts]),
        np.concatenate([part.rotations for part in parts]),
        motion.fps,
    ).slice(0, motion.frames + extra)


def frozen(motion: Motion, rng: np.random.Generator) -> Motion:
    """Hold the pose, and the place, of the frame in which the feet and the joints are fastest."""
    speed = np.linalg.norm(np.diff(motion.positions, axis=0), axis=-1)
    feet = [CANONICAL.index(f"{side}_foot") for side in ("left", "right")]
    busy = speed[:, feet].max(axis=1) + 0.1 * speed.mean(axis=1)
    first, last = round(0.2 * motion.frames), max(round(0.7 * motion.frames), 2)
    at = first + int(np.argmax(busy[first:last]))
    frames = np.minimum(np.arange(motion.frames), at)
    return replace(motion, root=motion.root[frames], rotations=motion.rotations[frames])


def legs_swapped(motion: Motion, rng: np.random.Generator) -> Motion:
    """Exchange the joint angles of the left and the right leg, as a mix-up of names would."""
    left, right = ([CANONICAL.index(f"{side}_{j}") for j in _LEG] for side in ("left", "right"))
    rotations = motion.rotations.copy()
    rotations[:, left + right] = rotations[:, right + left]
    return replace(motion, rotations=rotations)


CORRUPTIONS: dict[str, Corruption] = {
    "lifted 3 cm": Corruption(lifted(0.03)),
    "lifted 5 cm": Corruption(lifted(0.05), middle=True),
    "lifted 10 cm": Corruption(lifted(0.10)),
    "sunk 3 cm": Corruption(lifted(-0.03)),
    "sunk 5 cm": Corruption(lifted(-0.05), middle=True),
    "sunk 10 cm": Corruption(lifted(-0.10)),
    "slid 0.2 m/s": Corruption(slid(0.2)),
    "slid 0.5 m/s": Corruption(slid(0.5), middle=True),
    "jittered 1 deg": Corruption(jittered(1.0, 0.003)),
    "jittered 2 deg": Corruption(jittered(2.0, 0.006), middle=True),
    "jittered 3 deg": Corruption(jittered(3.0, 0.01)),
    "tilted 5 deg": Corruption(tilted(5.0)),
    "tilted 10 deg": Corruption(tilted(10.0), middle=True),
    "sped up 1.5x": Corruption(sped_up(1.5)),
    "sped up 2x": Corruption(sped_up(2.0), middle=True),
    "sped up 3x": Corruption(sped_up(3.0)),
    "hanging in the air": Corruption(hanging, middle=True),
    "frozen in mid-step": Corruption(frozen, middle=True),
    "legs swapped": Corruption(legs_swapped, middle=True),
}


def _longest_flight(motion: Motion) -> tuple[int, int]:
    lowest = np.minimum(*(sole_probes(s).heights(motion).min(axis=1) for s in ("left", "right")))
    padded = np.concatenate([[False], lowest > _IN_FLIGHT, [False]])
    edges = np.flatnonzero(np.diff(padded.astype(int))).reshape(-1, 2)
    if not len(edges):
        return 0, 0
    start, stop = max(edges, key=lambda edge: edge[1] - edge[0])
    return int(start), int(stop)


def _with_hanging_hop(motion: Motion, rng: np.random.Generator) -> Motion:
    frames = min(round(_HANG * _HOP * motion.fps), motion.frames)
    start = int(rng.integers(0, motion.frames - frames + 1))
    phase = (np.arange(frames) + 0.5) / frames
    rise = np.zeros((motion.frames, 3))
    rise[start : start + frames, 2] = 9.81 * _HOP**2 / 2 * phase * (1.0 - phase)
    return moved(motion, rise)
