"""The denoiser laid out for sampling: the same network in fewer and larger operations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import cast
from weakref import WeakKeyDictionary

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from motiondiffuse_ros.diffusion.attention import Attention, AttentionContext, pad_mask
from motiondiffuse_ros.diffusion.denoiser import (
    ConvolutionalHead,
    DecoderLayer,
    Denoiser,
    StylizationBlock,
    positions_of,
    step_embedding,
)
from motiondiffuse_ros.diffusion.product import GELU, Convolution, Product

_Linear = tuple[Tensor, Tensor]
"""Weight and bias."""


@dataclass(frozen=True)
class _Layer:
    own: Product
    """Queries, keys and values of the self-attention in one."""
    text_query: Product
    ffn: tuple[Product, Product]
    projections: tuple[Product, ...]
    """Of the three stylization blocks."""
    own_attention: Attention
    text_attention: Attention


class PreparedDenoiser:
    """A copy of a denoiser's weights in the arithmetic of the sampler.

    Autocast would convert all weights at every step, which takes as long as the products
    themselves. Scales and shifts of layer norms are merged into what follows them, so that
    queries, keys and values are one product, and all stylization vectors of a step another.
    """

    def __init__(self, denoiser: Denoiser, dtype: torch.dtype) -> None:
        """Copy the weights.

        Args:
            denoiser: In evaluation mode.
            dtype: Of the products: float32 or bfloat16. Sums stay float32.
        """
        config = denoiser.config
        self._config, self._dtype = config, dtype
        self._layers: list[_Layer] = []
        styles: list[_Linear] = []
        for layer in denoiser.layers:
            assert isinstance(layer, DecoderLayer)
            self._layers.append(self._prepared(layer))
            styles += [_style(cast("StylizationBlock", block)) for block in layer.styles]
        self._head = denoiser.head
        if isinstance(self._head, ConvolutionalHead):
            head = self._head
            styles.append(_scale_and_shift(head.style.weight, head.style.bias))
            self._unpatch = self._product(_after_norm(denoiser.norm, head.unpatch))
            self._skip = self._product(_of(head.skip))
            self._blocks = [
                (norm, Convolution(*_of(cast("nn.Conv1d", convolution)), dtype))
                for norm, convolution in zip(head.norms, head.convolutions, strict=True)
            ]
            self._out = self._product(_of(head.out))
        else:
            self._out = self._product(_after_norm(denoiser.norm, self._head.out))
        self._style_widths = [len(bias) for _, bias in styles]
        self._styles = self._product(
            (torch.cat([w for w, _ in styles]), torch.cat([b for _, b in styles]))
        )
        self._patch_in = self._product(_of(denoiser.patch_in))
        self._positions, end = denoiser.positions.detach(), denoiser.end_positions
        self._end_positions = None if end is None else end.detach()
        self._time_in = denoiser.time_in

    def _prepared(self, layer: DecoderLayer) -> _Layer:
        own, text = layer.self_attention, layer.cross_attention
        parts = [
            _after_norm(own.norm, own.query),
            _after_norm(own.context_norm, own.key),
            _after_norm(own.context_norm, own.value),
        ]
        merged = torch.cat([w for w, _ in parts]), torch.cat([b for _, b in parts])
        first, _, second = layer.ffn
        assert isinstance(first, nn.Linear)
        assert isinstance(second, nn.Linear)
        return _Layer(
            own=self._product(merged),
            text_query=self._product(_after_norm(text.norm, text.query)),
            ffn=(self._product(_of(first)), self._product(_of(second))),
            projections=tuple(
                self._product(_of(cast("StylizationBlock", block).project))
                for block in layer.styles
            ),
            own_attention=own,
            text_attention=text,
        )

    def _product(self, linear: _Linear) -> Product:
        return Product(*linear, self._dtype)

    def styles(self, steps: Sequence[int], pooled: Tensor) -> Tensor:
        """Return all stylization vectors [S, B, K] of some steps for some texts.

        Args:
            steps: Diffusion steps.
            pooled: `Conditioning.pooled` of B texts.
        """
        at = torch.tensor(steps, device=pooled.device)
        time = self._time_in(step_embedding(at, self._config.width))
        embedding = F.silu(time[:, None] + pooled.float()).to(self._dtype)
        return self._styles(embedding)

    def __call__(
        self,
        x: Tensor,
        lengths: Tensor,
        contexts: Sequence[AttentionContext],
        styles: Tensor,
    ) -> Tensor:
        """Return the prediction for noisy features; see `Denoiser.forward`.

        Args:
            x: Normalised noisy features [B, T, D].
            lengths: Frames that count in each row [B].
            contexts: `Conditioning.contexts` of B texts, in the arithmetic of the sampler.
            styles: [B, K] of their step and texts.
        """
        dtype, patch = self._dtype, self._config.patch_size
        frames = x.shape[1]
        frame_mask = pad_mask(lengths, frames)
        x = F.pad(x * frame_mask[..., None], (0, 0, 0, -frames % patch)).to(dtype)
        frame_mask = F.pad(frame_mask, (0, -frames % patch))
        token_mask = frame_mask.unflatten(1, (-1, patch)).any(-1)
        if token_mask.all():
            token_mask = None
        tokens = self._patch_in(x.unflatten(1, (-1, patch)).flatten(2))
        tokens = tokens + positions_of(
            self._positions, self._end_positions, -(-lengths // patch), tokens.shape[1]
        )
        pieces = iter(styles[:, None].split(self._style_widths, dim=-1))
        for layer, text in zip(self._layers, contexts, strict=True):
            self._pass(layer, tokens, token_mask, text, pieces)
        hidden = F.layer_norm(tokens, tokens.shape[-1:]).to(dtype)
        if not isinstance(self._head, ConvolutionalHead):
            y = self._out(hidden).unflatten(-1, (patch, -1)).flatten(1, 2)
            return y[:, :frames].float()
        hidden = self._unpatch(hidden).unflatten(-1, (patch, -1)).flatten(1, 2)
        hidden = hidden + self._skip(x)
        scale, shift = next(pieces).chunk(2, dim=-1)
        hidden = torch.addcmul(shift, hidden, scale).float()
        for norm, convolution in self._blocks:
            y = F.silu(norm(hidden), inplace=True) * frame_mask[..., None]
            hidden += convolution(y.to(dtype))
        return self._out(hidden.to(dtype))[:, :frames].float()

    def _pass(
        self,
        layer: _Layer,
        tokens: Tensor,
        mask: Tensor | None,
        text: AttentionContext,
        styles: Iterator[Tensor],
    ) -> None:
        """Add to the tokens what one decoder layer makes of them."""
        dtype, width = self._dtype, tokens.shape[2]
        own, cross = layer.own_attention, layer.text_attention
        z = F.layer_norm(tokens, (width,)).to(dtype)
        query, key, value = layer.own(z).chunk(3, dim=-1)
        y = own.read(query, own.summary(key, value, mask))
        tokens += self._styled(y, next(styles), layer.projections[0])
        z = F.layer_norm(tokens, (width,)).to(dtype)
        y = cross.read(layer.text_query(z), text)
        tokens += self._styled(y, next(styles), layer.projections[1])
        first, second = layer.ffn
        y = second(first(tokens.to(dtype), GELU))
        tokens += self._styled(y, next(styles), layer.projections[2])

    def _styled(self, y: Tensor, style: Tensor, projection: Product) -> Tensor:
        scale, shift = style.chunk(2, dim=-1)
        z = torch.addcmul(shift, F.layer_norm(y, y.shape[-1:]), scale)
        return projection(F.silu(z, inplace=True))


_KEPT: WeakKeyDictionary[Denoiser, tuple[object, PreparedDenoiser]] = WeakKeyDictionary()


def prepared(denoiser: Denoiser, dtype: torch.dtype) -> PreparedDenoiser:
    """Return a denoiser laid out for sampling; made anew only if its weights have changed."""
    state = (dtype, *((p.data_ptr(), p._version) for p in denoiser.parameters()))
    kept = _KEPT.get(denoiser)
    if kept is None or kept[0] != state:
        kept = (state, PreparedDenoiser(denoiser, dtype))
        _KEPT[denoiser] = kept
    return kept[1]


def _of(linear: nn.Linear | nn.Conv1d) -> _Linear:
    assert linear.bias is not None
    return linear.weight, linear.bias


def _after_norm(norm: nn.LayerNorm, linear: nn.Linear) -> _Linear:
    """Return the linear layer that does to plainly normalised input what norm and layer do."""
    return linear.weight * norm.weight, linear.bias + linear.weight @ norm.bias


def _scale_and_shift(weight: Tensor, bias: Tensor) -> _Linear:
    """Return the layer whose first half is 1 + the scale."""
    width = len(bias) // 2
    return weight, bias + (torch.arange(len(bias), device=bias.device) < width)


def _style(block: StylizationBlock) -> _Linear:
    """Return the layer whose halves scale and shift what is normalised without weights."""
    weight, bias = _scale_and_shift(block.embedding.weight, block.embedding.bias)
    gain, offset = block.norm.weight, block.norm.bias
    (scale_w, shift_w), (scale_b, shift_b) = weight.chunk(2), bias.chunk(2)
    return (
        torch.cat([gain[:, None] * scale_w, shift_w + offset[:, None] * scale_w]),
        torch.cat([gain * scale_b, shift_b + offset * scale_b]),
    )
