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
        pairs: Steps of the student, each of which stands for two of the teacher's, from the
            noisiest on. Those are the costly ones: guidance doubles them, and all candidates do
            them.
        then: Diffusion steps at which the teacher goes on, without guidance, from where the student
            arrives.
        batch_size: Motions at once; each is taken through all steps of the student.
        learning_rate: Peak of the cosine schedule.
        warmup_steps: Steps of linear warm-up.
        weight_decay: Of AdamW, on matrices.
        gradient_clip: Largest gradient norm.
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
    pairs: int = 2
    then: tuple[int, ...] = (822, 512, 283)
    batch_size: int = 16
    learning_rate: float = 3e-4
    warmup_steps: int = 50
    weight_decay: float = 0.0
    gradient_clip: float = 1.0
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
        if not 2 <= 2 * self.pairs < self.teacher_steps:
            raise InputError(
                "distilling pairs must be at least 1 and less than half of the teacher's "
                f"{self.teacher_steps} steps, got {self.pairs}"
            )
        for name in ("statements", "deeds", "ema_decay"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(
                    f"distilling {name} must be from 0 to 1, got {getattr(self, name)}"
                )

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types."""
        return asdict(self)
