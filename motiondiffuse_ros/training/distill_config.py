"""Settings of a distillation."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from motiondiffuse_ros.diffusion.precision import check_precision
from motiondiffuse_ros.errors import InputError


@dataclass(frozen=True)
class DistillConfig:
    """How a student learns to denoise in few steps; written beside its checkpoints.

    Attributes:
        minutes: Time in all; the learning rate follows it.
        teacher_steps: Denoising steps of the teacher.
        pairs: How many of the student's steps stand for two of the teacher's, from the noisiest
            on; the others stand for one. Details are made of the last ones, which are also the
            cheapest: guidance is not used there.
        batch_size: Motions at once; each gives `steps` pairs to learn from.
        learning_rate: Peak of the cosine schedule.
        warmup_steps: Steps of linear warm-up.
        weight_decay: Of AdamW, on matrices.
        gradient_clip: Largest gradient norm.
        whole: Share of batches that go all the way to clean motions; the others are taught half of
            the steps, the noisiest, which take longest to learn.
        statements: Share of texts that state kinematics; see `TrainConfig`.
        deeds: Share of texts drawn by what is done; see `TrainConfig`.
        difference_weight: Weight of the loss on frame-to-frame differences.
        position_weight: Weight of the loss on joint positions by forward kinematics.
        velocity_weight: Weight of the loss on joint velocities by forward kinematics.
        slide_weight: Weight of the loss on feet that move while in contact.
        ema_decay: Largest decay of the averaged weights.
        precision: Arithmetic: auto, fp32 or bf16.
        seed: Of texts, lengths and noise.
        save_minutes: Time between checkpoints.
        validate_steps: Steps between validations.
    """

    minutes: float = 60.0
    teacher_steps: int = 8
    pairs: int = 3
    batch_size: int = 16
    learning_rate: float = 3e-4
    warmup_steps: int = 50
    weight_decay: float = 0.0
    gradient_clip: float = 1.0
    whole: float = 0.4
    statements: float = 0.3
    deeds: float = 0.2
    difference_weight: float = 3.0
    position_weight: float = 0.5
    velocity_weight: float = 0.5
    slide_weight: float = 0.5
    ema_decay: float = 0.995
    precision: str = "auto"
    seed: int = 0
    save_minutes: float = 5.0
    validate_steps: int = 100

    def validate(self) -> None:
        """Raise InputError if a value is out of range."""
        check_precision(self.precision)
        positive = ("minutes", "teacher_steps", "batch_size", "learning_rate", "save_minutes")
        for name in (*positive, "validate_steps"):
            if not getattr(self, name) > 0:
                raise InputError(f"distilling {name} must be positive, got {getattr(self, name)}")
        if not 0 <= 2 * self.pairs <= self.teacher_steps:
            raise InputError(
                f"distilling pairs must be from 0 to half of the {self.teacher_steps} steps of the "
                f"teacher, got {self.pairs}"
            )
        for name in ("whole", "statements", "deeds", "ema_decay"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(
                    f"distilling {name} must be from 0 to 1, got {getattr(self, name)}"
                )

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types."""
        return asdict(self)
