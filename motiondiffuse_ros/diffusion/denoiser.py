"""The Cross-Modality Linear Transformer (section 3.4 and figure 2 of the paper)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from motiondiffuse_ros.diffusion.attention import Attention, AttentionContext, pad_mask
from motiondiffuse_ros.diffusion.config import DenoiserConfig
from motiondiffuse_ros.diffusion.initial import small_normal


@dataclass(frozen=True)
class Conditioning:
    """All that the denoiser needs of the texts; the same at every denoising step.

    Attributes:
        contexts: For each decoder layer the summary its cross-attention reads.
        pooled: [B, time_width], added to the time embedding.
    """

    contexts: tuple[AttentionContext, ...]
    pooled: Tensor

    def expand(self, index: Tensor) -> Conditioning:
        """Select rows of the batch (with repeats)."""
        return Conditioning(tuple(c.expand(index) for c in self.contexts), self.pooled[index])

    def beside(self, other: Conditioning) -> Conditioning:
        """Return these rows of the batch, then those of another."""
        contexts = zip(self.contexts, other.contexts, strict=True)
        return Conditioning(
            tuple(own.beside(others) for own, others in contexts),
            torch.cat([self.pooled, other.pooled]),
        )


class StylizationBlock(nn.Module):
    """Scale and shift by the time and text embedding, then project (eq. 9)."""

    def __init__(self, width: int, time_width: int, dropout: float) -> None:
        super().__init__()
        self.embedding = nn.Linear(time_width, 2 * width)
        self.norm = nn.LayerNorm(width)
        self.dropout = nn.Dropout(dropout)
        self.project = nn.Linear(width, width)
        nn.init.zeros_(self.project.weight)  # each block starts as the identity
        nn.init.zeros_(self.project.bias)

    def forward(self, y: Tensor, embedding: Tensor) -> Tensor:
        scale, shift = self.embedding(F.silu(embedding))[:, None].chunk(2, dim=-1)
        return self.project(self.dropout(F.silu(self.norm(y) * (1 + scale) + shift)))


class DecoderLayer(nn.Module):
    """Self-attention, cross-attention and FFN, each with stylization and a residual."""

    def __init__(self, config: DenoiserConfig) -> None:
        super().__init__()
        width = config.width
        self.self_attention = Attention(width, width, config.heads, config.attention)
        self.cross_attention = Attention(width, config.text_width, config.heads, config.attention)
        self.ffn = nn.Sequential(
            nn.Linear(width, config.ffn_width), nn.GELU(), nn.Linear(config.ffn_width, width)
        )
        self.styles = nn.ModuleList(
            StylizationBlock(width, config.time_width, config.dropout) for _ in range(3)
        )

    def read_text(self, tokens: Tensor, mask: Tensor) -> AttentionContext:
        """Return what the cross-attention needs of text tokens [B, L, text_width]."""
        return self.cross_attention.context(tokens, mask)

    def forward(self, x: Tensor, mask: Tensor, text: AttentionContext, embedding: Tensor) -> Tensor:
        own = self.self_attention.context(x, mask)
        x = x + self.styles[0](self.self_attention(x, own), embedding)
        x = x + self.styles[1](self.cross_attention(x, text), embedding)
        return x + self.styles[2](self.ffn(x), embedding)


class ConvolutionalHead(nn.Module):
    """From patch tokens back to frames: a small temporal network that sees the noisy frames too.

    Un-patching by a linear layer alone leaves a step between patches; here every frame is made
    from its neighbours across the patch border.
    """

    def __init__(self, config: DenoiserConfig, kernel: int = 5, blocks: int = 2) -> None:
        super().__init__()
        width = config.head_width
        self.patch_size = config.patch_size
        self.unpatch = nn.Linear(config.width, config.patch_size * width)
        self.skip = nn.Linear(config.feature_dim, width)
        self.style = nn.Linear(config.time_width, 2 * width)
        self.norms = nn.ModuleList(nn.LayerNorm(width) for _ in range(blocks))
        self.convolutions = nn.ModuleList(
            nn.Conv1d(width, width, kernel, padding=kernel // 2) for _ in range(blocks)
        )
        self.out = nn.Linear(width, config.feature_dim)

    def forward(self, tokens: Tensor, x: Tensor, mask: Tensor, embedding: Tensor) -> Tensor:
        hidden = self.unpatch(tokens).unflatten(-1, (self.patch_size, -1)).flatten(1, 2)
        hidden = hidden + self.skip(x)
        scale, shift = self.style(F.silu(embedding))[:, None].chunk(2, dim=-1)
        hidden = hidden * (1 + scale) + shift
        for norm, convolution in zip(self.norms, self.convolutions, strict=True):
            y = F.silu(norm(hidden)) * mask[..., None]
            hidden = hidden + convolution(y.transpose(1, 2)).transpose(1, 2)
        return self.out(hidden)


class LinearHead(nn.Module):
    """The paper's output layer: one linear map per token."""

    def __init__(self, config: DenoiserConfig) -> None:
        super().__init__()
        self.patch_size = config.patch_size
        self.out = nn.Linear(config.width, config.patch_size * config.feature_dim)

    def forward(self, tokens: Tensor, x: Tensor, mask: Tensor, embedding: Tensor) -> Tensor:
        return self.out(tokens).unflatten(-1, (self.patch_size, -1)).flatten(1, 2)


class Denoiser(nn.Module):
    """Predicts noise, clean features or velocity from noisy features, a step and a text."""

    def __init__(self, config: DenoiserConfig) -> None:
        super().__init__()
        config.validate()
        self.config = config
        width, time_width = config.width, config.time_width
        self.text_in = nn.Linear(config.text_dim, config.text_width)
        self.text_layers = nn.TransformerEncoder(
            nn.TransformerEncoderLayer(
                config.text_width,
                config.text_heads,
                config.text_ffn_width,
                dropout=config.dropout,
                activation="gelu",
                batch_first=True,
                norm_first=True,
            ),
            config.text_layers,
            enable_nested_tensor=False,
        )
        self.text_norm = nn.LayerNorm(config.text_width)
        self.text_pool = nn.Linear(config.text_width, time_width)
        self.time_in = nn.Sequential(
            nn.Linear(width, time_width), nn.SiLU(), nn.Linear(time_width, time_width)
        )
        self.patch_in = nn.Linear(config.patch_size * config.feature_dim, width)
        self.positions = small_normal(config.max_frames // config.patch_size, width)
        # zeros: weights without them can be trained on
        self.end_positions = (
            nn.Parameter(torch.zeros(self.positions.shape)) if config.end_positions else None
        )
        self.layers = nn.ModuleList(DecoderLayer(config) for _ in range(config.layers))
        self.norm = nn.LayerNorm(width)
        self.head = ConvolutionalHead(config) if config.head_width else LinearHead(config)

    def _decoder(self) -> list[DecoderLayer]:
        return [layer for layer in self.layers if isinstance(layer, DecoderLayer)]

    @property
    def device(self) -> torch.device:
        """Where the weights are."""
        return self.positions.device

    def condition(self, states: Tensor, mask: Tensor) -> Conditioning:
        """Encode texts once for all steps.

        Args:
            states: Token states [B, L, text_dim] of the frozen encoder.
            mask: [B, L] bool, true on tokens.
        """
        x = self.text_layers(self.text_in(states), src_key_padding_mask=~mask)
        x = self.text_norm(x)
        weight = mask[..., None].to(x.dtype)
        pooled = self.text_pool((x * weight).sum(1) / weight.sum(1))
        contexts = tuple(layer.read_text(x, mask) for layer in self._decoder())
        return Conditioning(contexts, pooled)

    def forward(
        self, x: Tensor, steps: Tensor, lengths: Tensor, conditioning: Conditioning
    ) -> Tensor:
        """Return the prediction for noisy features.

        Args:
            x: Normalised noisy features [B, T, D]; T at most max_frames.
            steps: Diffusion steps [B], 0 (clean) to train_steps - 1.
            lengths: Frames that count in each row [B]; the rest is padding.
            conditioning: Of B texts.

        Returns:
            [B, T, D] in float32; meaningful on the first `lengths` frames.
        """
        frames, patch = x.shape[1], self.config.patch_size
        frame_mask = pad_mask(lengths, frames)
        x = x * frame_mask[..., None]
        x = F.pad(x, (0, 0, 0, -frames % patch))
        frame_mask = F.pad(frame_mask, (0, -frames % patch))
        tokens = self.patch_in(x.unflatten(1, (-1, patch)).flatten(2))
        tokens = tokens + positions_of(
            self.positions, self.end_positions, -(-lengths // patch), tokens.shape[1]
        )
        token_mask = frame_mask.unflatten(1, (-1, patch)).any(-1)
        embedding = self.time_in(step_embedding(steps, self.config.width)) + conditioning.pooled
        for layer, context in zip(self._decoder(), conditioning.contexts, strict=True):
            tokens = layer(tokens, token_mask, context, embedding)
        y = self.head(self.norm(tokens), x, frame_mask, embedding)
        return y[:, :frames].float()


def positions_of(start: Tensor, end: Tensor | None, tokens: Tensor, count: int) -> Tensor:
    """Return what is added to the tokens of each row, [count, width] or [B, count, width].

    Args:
        start: For each token from the first on [N, width].
        end: For each from the last one back [N, width], if there are such.
        tokens: How many count in each row [B].
        count: How many there are, with padding.
    """
    if end is None:
        return start[:count]
    left = tokens[:, None] - 1 - torch.arange(count, device=tokens.device)
    return start[:count] + end[left.clamp(min=0)]


def step_embedding(steps: Tensor, width: int) -> Tensor:
    """Return the sinusoidal embedding [B, width] of diffusion steps [B]."""
    half = width // 2
    rates = torch.exp(-math.log(10000.0) * torch.arange(half, device=steps.device) / half)
    angles = steps.float()[:, None] * rates[None]
    return torch.cat([angles.cos(), angles.sin()], dim=-1)
