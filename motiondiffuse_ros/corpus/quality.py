"""Which clips are fit to learn from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from motiondiffuse_ros.errors import CorpusError
from motiondiffuse_ros.motion import Motion


@dataclass(frozen=True)
class QualityConfig:
    """Limits beyond which a clip is dropped.

    Attributes:
        min_seconds: Shortest clip, s.
        max_seconds: Longest clip, s.
        max_joint_speed: Fastest joint relative to the root, m/s; capture glitches jump.
        max_root_speed: Fastest root, m/s; sprinters reach 8 at this size.
    """

    min_seconds: float = 0.8
    max_seconds: float = 120.0
    max_joint_speed: float = 15.0
    max_root_speed: float = 8.0

    def validate(self) -> None:
        """Raise CorpusError if a limit is not positive or the durations are reversed."""
        for name, value in vars(self).items():
            if not value > 0:
                raise CorpusError(f"quality limit {name} must be positive, got {value}")
        if self.max_seconds < self.min_seconds:
            raise CorpusError(
                f"max_seconds {self.max_seconds} is below min_seconds {self.min_seconds}"
            )


def reason_to_drop(motion: Motion, captions: tuple[str, ...], config: QualityConfig) -> str | None:
    """Return why a clip should be dropped, or None if it should be kept."""
    if not captions:
        return "no caption"
    if not (np.isfinite(motion.root).all() and np.isfinite(motion.rotations).all()):
        return "not finite"
    if motion.duration < config.min_seconds:
        return f"shorter than {config.min_seconds:g} s"
    if motion.duration > config.max_seconds:
        return f"longer than {config.max_seconds:g} s"
    root_speed = np.linalg.norm(np.diff(motion.root, axis=0), axis=-1) * motion.fps
    if root_speed.max() > config.max_root_speed:
        return f"root faster than {config.max_root_speed:g} m/s"
    relative = motion.positions - motion.positions[:, :1]
    joint_speed = np.linalg.norm(np.diff(relative, axis=0), axis=-1) * motion.fps
    if joint_speed.max() > config.max_joint_speed:
        return f"joint faster than {config.max_joint_speed:g} m/s"
    return None
