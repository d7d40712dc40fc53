"""The evaluator: text and motion in one space (Guo et al. 2022; TMR, Petrovich et al. 2023)."""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from motiondiffuse_ros.diffusion.attention import pad_mask
from motiondiffuse_ros.diffusion.initial import small_normal
from motiondiffuse_ros.evaluation.config import EvaluatorConfig


class SequenceEncoder(nn.Module):
    """A transformer that reads a sequence into one vector."""

    def __init__(
        self, input_dim: int, tokens: int, layers: int, out_dim: int, config: EvaluatorConfig
    ) -> None:
        super().__init__()
        width = config.width
        self.project = nn.Linear(input_dim, width)
        self.summary = small_normal(width)
        self.positions = small_normal(tokens, width)
        layer = nn.TransformerEncoderLayer(
            width,
            config.heads,
            4 * width,
            dropout=config.dropout,
            activation="gelu",
            batch_first=True,
            norm_first=True,
        )
        self.layers = nn.TransformerEncoder(layer, layers, enable_nested_tensor=False)
        self.norm = nn.LayerNorm(width)
        self.out = nn.Linear(width, out_dim)

    def forward(self, x: Tensor, mask: Tensor) -> Tensor:
        """Return [B, out_dim] of sequences [B, L, input_dim] with mask [B, L] (true on tokens)."""
        tokens = self.project(x) + self.positions[: x.shape[1]]
        tokens = torch.cat([self.summary.expand(len(x), 1, -1).to(tokens.dtype), tokens], dim=1)
        mask = F.pad(mask, (1, 0), value=True)
        return self.out(self.norm(self.layers(tokens, src_key_padding_mask=~mask)[:, 0])).float()


def motion_encoder(out_dim: int, config: EvaluatorConfig) -> SequenceEncoder:
    """Return an encoder of patches of motion features."""
    tokens = -(-config.max_frames // config.patch_size)
    patch = config.patch_size * config.feature_dim
    return SequenceEncoder(patch, tokens, config.motion_layers, out_dim, config)


def encode_patches(encoder: SequenceEncoder, x: Tensor, lengths: Tensor, patch: int) -> Tensor:
    """Return `encoder`'s vectors of normalised features [B, T, D] of some lengths [B]."""
    mask = pad_mask(lengths, x.shape[1])
    x = F.pad(x * mask[..., None], (0, 0, 0, -x.shape[1] % patch))
    mask = F.pad(mask, (0, -mask.shape[1] % patch)).unflatten(1, (-1, patch)).any(-1)
    return encoder(x.unflatten(1, (-1, patch)).flatten(2), mask)


class TextMotionNetwork(nn.Module):
    """Both encoders and the temperature of their contrastive loss."""

    _MAX_TOKENS = 128

    def __init__(self, config: EvaluatorConfig) -> None:
        super().__init__()
        self.config = config
        self.motion = motion_encoder(config.space, config)
        self.text = SequenceEncoder(
            config.text_dim, self._MAX_TOKENS, config.text_layers, config.space, config
        )
        self.log_scale = nn.Parameter(torch.tensor(2.3))

    def embed_motion(self, x: Tensor, lengths: Tensor) -> Tensor:
        """Return unit vectors [B, space] of normalised features [B, T, D]."""
        return F.normalize(encode_patches(self.motion, x, lengths, self.config.patch_size), dim=-1)

    def embed_text(self, states: Tensor, mask: Tensor) -> Tensor:
        """Return unit vectors [B, space] of token states [B, L, text_dim]."""
        return F.normalize(self.text(states, mask), dim=-1)


class ActionNetwork(nn.Module):
    """A recogniser of actions; its last hidden vector is the space of its FID (ACTOR)."""

    def __init__(self, config: EvaluatorConfig, actions: int) -> None:
        super().__init__()
        self.config = config
        self.motion = motion_encoder(config.space, config)
        self.classify = nn.Linear(config.space, actions)

    def embed(self, x: Tensor, lengths: Tensor) -> Tensor:
        """Return [B, space] of normalised features [B, T, D]."""
        return encode_patches(self.motion, x, lengths, self.config.patch_size)

    def forward(self, x: Tensor, lengths: Tensor) -> Tensor:
        """Return logits [B, actions]."""
        return self.classify(F.gelu(self.embed(x, lengths)))
