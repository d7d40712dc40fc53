"""Everything that shapes the denoiser and its diffusion process, in one frozen record."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import Any

from motiondiffuse_ros.errors import CheckpointError

PREDICTION_TYPES = ("epsilon", "sample", "v_prediction")
BETA_SCHEDULES = ("linear", "scaled_linear", "squaredcos_cap_v2")
ATTENTIONS = ("efficient", "full")


@dataclass(frozen=True)
class DenoiserConfig:
    """Architecture of the Cross-Modality Linear Transformer and its noise schedule.

    The defaults train on two CPU cores; `paper()` is the paper's.

    Attributes:
        feature_dim: Width D of the pose state.
        max_frames: Longest window, frames.
        fps: Frame rate of the features, Hz.
        representation: Name of the pose state.
        width: Width of the motion tokens.
        layers: Decoder layers.
        heads: Attention heads.
        ffn_width: Hidden width of the feed-forward networks.
        patch_size: Frames per token; 1 is the paper's.
        head_width: Width of the convolutional head that follows un-patching (0: a plain linear
            layer, the paper's). Without it patches of several frames leave seams.
        attention: "efficient" (eq. 8) or "full".
        end_positions: Whether motion tokens know how far the end is, too (not the paper's). A turn
            by ninety degrees is slow where there is much time.
        time_width: Width of the embedding that steers the stylization blocks.
        text_encoder: Name of the frozen encoder.
        text_dim: Width of its token states.
        text_width: Width of the trainable text layers.
        text_layers: Number of trainable text layers.
        text_heads: Their heads.
        text_ffn_width: Their feed-forward width.
        dropout: Dropout probability while training.
        train_steps: Length of the noise schedule.
        beta_schedule: One of `BETA_SCHEDULES`.
        beta_start: First beta of the linear schedules.
        beta_end: Last beta of the linear schedules.
        prediction_type: What the network's output means, one of `PREDICTION_TYPES`.
    """

    feature_dim: int = 269
    max_frames: int = 196
    fps: float = 20.0
    representation: str = "pose_state"
    width: int = 384
    layers: int = 6
    heads: int = 8
    ffn_width: int = 1024
    patch_size: int = 4
    head_width: int = 128
    attention: str = "efficient"
    end_positions: bool = True
    time_width: int = 512
    text_encoder: str = "minilm"
    text_dim: int = 384
    text_width: int = 256
    text_layers: int = 4
    text_heads: int = 4
    text_ffn_width: int = 1024
    dropout: float = 0.0
    train_steps: int = 1000
    beta_schedule: str = "squaredcos_cap_v2"
    beta_start: float = 1e-4
    beta_end: float = 0.02
    prediction_type: str = "sample"

    @classmethod
    def paper(cls, feature_dim: int = 269) -> DenoiserConfig:
        """Return the paper's configuration (section 4.1 and its released code)."""
        return cls(
            feature_dim=feature_dim,
            width=512,
            layers=8,
            heads=8,
            ffn_width=1024,
            patch_size=1,
            head_width=0,
            attention="efficient",
            end_positions=False,
            time_width=2048,
            text_encoder="clip",
            text_dim=512,
            text_width=256,
            text_layers=4,
            text_heads=4,
            text_ffn_width=2048,
            dropout=0.0,
            train_steps=1000,
            beta_schedule="linear",
            prediction_type="epsilon",
        )

    def validate(self) -> None:
        """Raise CheckpointError if a value is out of range; lists the valid choices."""
        for name in ("feature_dim", "max_frames", "width", "layers", "heads", "ffn_width"):
            if getattr(self, name) < 1:
                raise CheckpointError(f"denoiser {name} must be at least 1")
        for name, choices in (
            ("prediction_type", PREDICTION_TYPES),
            ("beta_schedule", BETA_SCHEDULES),
            ("attention", ATTENTIONS),
        ):
            if getattr(self, name) not in choices:
                raise CheckpointError(
                    f"denoiser {name} '{getattr(self, name)}' is not one of {', '.join(choices)}"
                )
        if self.width % self.heads or self.text_width % self.text_heads:
            raise CheckpointError(
                f"denoiser widths must be multiples of their heads: {self.width} by {self.heads}, "
                f"{self.text_width} by {self.text_heads}"
            )
        if self.max_frames % self.patch_size:
            raise CheckpointError(
                f"denoiser max_frames {self.max_frames} is not a multiple of patch_size "
                f"{self.patch_size}"
            )

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON types."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> DenoiserConfig:
        """Build and validate from `to_dict`'s result.

        Raises:
            CheckpointError: If a field is unknown or invalid.
        """
        known = {f.name for f in fields(cls)}
        if not isinstance(data, dict) or not set(data) <= known:
            raise CheckpointError(f"denoiser configuration with unknown fields: {data!r:.200}")
        config = cls(**{"end_positions": False, **data})  # weights from before there were any
        config.validate()
        return config
