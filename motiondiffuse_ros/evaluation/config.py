"""Settings of the evaluator network and its training."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import Any

from motiondiffuse_ros.errors import CheckpointError, InputError


@dataclass(frozen=True)
class EvaluatorConfig:
    """Shape of the two encoders that share one space.

    Attributes:
        feature_dim: Width of the motion features.
        max_frames: Longest motion, frames.
        patch_size: Frames a token.
        text_encoder: Name of the frozen encoder.
        text_dim: Width of its token states.
        width: Width of both transformers.
        motion_layers: Layers of the motion encoder.
        text_layers: Layers of the text encoder.
        heads: Attention heads.
        space: Width of the shared space.
        dropout: Probability while training.
    """

    feature_dim: int = 269
    max_frames: int = 196
    patch_size: int = 4
    text_encoder: str = "minilm"
    text_dim: int = 384
    width: int = 256
    motion_layers: int = 4
    text_layers: int = 2
    heads: int = 4
    space: int = 128
    dropout: float = 0.1

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> EvaluatorConfig:
        """Build from `to_dict`'s result.

        Raises:
            CheckpointError: If a field is unknown.
        """
        if not isinstance(data, dict) or not set(data) <= {f.name for f in fields(cls)}:
            raise CheckpointError(f"evaluator configuration with unknown fields: {data!r:.200}")
        return cls(**data)


@dataclass(frozen=True)
class EvaluatorTraining:
    """How the evaluator and the action recogniser are trained.

    Attributes:
        minutes: Training time of the text-motion evaluator.
        action_minutes: Training time of the action recogniser.
        steps: Steps of each of the two instead of minutes, for a run that can be repeated to the
            bit; 0 goes by time.
        batch_size: Pairs a step; the others of a batch are the wrong answers.
        learning_rate: Peak of the cosine schedule.
        weight_decay: Of AdamW.
        statements: Share of pairs whose text is what the kinematics state.
        seed: Of weights and batches.
    """

    minutes: float = 12.0
    action_minutes: float = 4.0
    steps: int = 0
    batch_size: int = 128
    learning_rate: float = 4e-4
    weight_decay: float = 0.05
    statements: float = 0.3
    seed: int = 0

    def validate(self) -> None:
        """Raise InputError if a value is out of range."""
        for name in ("minutes", "action_minutes", "learning_rate"):
            if not getattr(self, name) > 0:
                raise InputError(f"evaluator {name} must be positive, got {getattr(self, name)}")
        if self.steps < 0:
            raise InputError(f"evaluator steps must be 0 or more, got {self.steps}")
        if self.batch_size < 2:
            raise InputError(f"evaluator batch_size must be at least 2, got {self.batch_size}")
        if not 0.0 <= self.statements <= 1.0:
            raise InputError(f"evaluator statements must be from 0 to 1, got {self.statements}")

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types."""
        return asdict(self)
