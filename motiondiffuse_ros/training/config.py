"""Settings of a training run."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from motiondiffuse_ros.diffusion.precision import check_precision
from motiondiffuse_ros.errors import InputError


@dataclass(frozen=True)
class TrainConfig:
    """How a denoiser is trained; written beside its checkpoints.

    Attributes:
        minutes: Training time in all, over every resumed piece; the learning rate follows it.
        batch_size: Windows a step, of each process.
        learning_rate: Peak of the cosine schedule.
        warmup_steps: Steps of linear warm-up.
        weight_decay: Of AdamW, on matrices.
        gradient_clip: Largest gradient norm.
        condition_dropout: Share of windows trained with the empty text, for guidance.
        mirror: Share of windows that are mirrored, with left and right swapped in the text.
        statements: Share of windows whose text is what their kinematics state for certain.
        deeds: Share of windows drawn by what is done in them, as other words name it
            (`corpus.wordings`), so that rare deeds are seen as often as frequent ones.
        crop: Share of windows of clips longer than a window that are shown in shorter pieces.
        difference_weight: Weight of the loss on frame-to-frame differences.
        position_weight: Weight of the loss on joint positions by forward kinematics.
        velocity_weight: Weight of the loss on joint velocities by forward kinematics.
        slide_weight: Weight of the loss on feet that move while in contact.
        alignment_weight: Weight of the loss that draws the pooled text towards the text space of
            the critic, if the trainer is given one.
        noisiest: Share of windows whose step is one of the noisiest 15 %; the others' is any.
        snr_limit: Largest weight of windows with little noise; 1 weighs all noise levels alike.
        ema_decay: Largest decay of the averaged weights.
        precision: Arithmetic of the denoiser: auto, fp32 or bf16.
        seed: Of initial weights, batches and noise.
        save_minutes: Time between checkpoints.
        validate_steps: Steps between validations.
    """

    minutes: float = 105.0
    batch_size: int = 64
    learning_rate: float = 5e-4
    warmup_steps: int = 200
    weight_decay: float = 0.01
    gradient_clip: float = 1.0
    condition_dropout: float = 0.1
    mirror: float = 0.5
    statements: float = 0.3
    deeds: float = 0.0
    crop: float = 0.5
    difference_weight: float = 3.0
    position_weight: float = 0.5
    velocity_weight: float = 0.3
    slide_weight: float = 0.3
    alignment_weight: float = 0.2
    noisiest: float = 0.5
    snr_limit: float = 1.0
    ema_decay: float = 0.999
    precision: str = "auto"
    seed: int = 0
    save_minutes: float = 5.0
    validate_steps: int = 400

    def validate(self) -> None:
        """Raise InputError if a value is out of range."""
        check_precision(self.precision)
        positive = ("minutes", "batch_size", "learning_rate", "save_minutes", "validate_steps")
        for name in positive:
            if not getattr(self, name) > 0:
                raise InputError(f"training {name} must be positive, got {getattr(self, name)}")
        if not self.snr_limit >= 1.0:
            raise InputError(f"training snr_limit must be at least 1, got {self.snr_limit}")
        shares = ("condition_dropout", "mirror", "statements", "deeds", "crop", "noisiest")
        for name in (*shares, "ema_decay"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"training {name} must be from 0 to 1, got {getattr(self, name)}")
        if self.statements + self.deeds > 1.0:
            raise InputError(
                f"training statements and deeds are shares of one whole, got {self.statements} and "
                f"{self.deeds}"
            )

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types."""
        return asdict(self)
