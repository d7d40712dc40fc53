"""Text and noise to prediction in one call, as data-parallel training needs it."""

from __future__ import annotations

from torch import Tensor, nn

from motiondiffuse_ros.diffusion.denoiser import Denoiser
from motiondiffuse_ros.text import TokenStates


class TextToPrediction(nn.Module):
    """A denoiser that reads its texts in the same call.

    Gradients are gathered from what one call of a module used, and a denoiser's texts and motions
    are two calls.
    """

    def __init__(self, denoiser: Denoiser) -> None:
        super().__init__()
        self.denoiser = denoiser

    def forward(
        self, tokens: TokenStates, noisy: Tensor, steps: Tensor, lengths: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Return the denoiser's prediction [B, T, D] and the pooled texts [B, time_width].

        Args:
            tokens: Of B texts.
            noisy: Normalised noisy features [B, T, D].
            steps: Diffusion steps [B].
            lengths: Frames that count [B].

        The arguments may be on any device; what is returned is where `noisy` is.
        """
        device = self.denoiser.device
        conditioning = self.denoiser.condition(tokens.states.to(device), tokens.mask.to(device))
        output = self.denoiser(noisy.to(device), steps.to(device), lengths.to(device), conditioning)
        return output.to(noisy.device), conditioning.pooled.to(noisy.device)
