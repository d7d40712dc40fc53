"""A denoiser small enough to run in a blink, with every kind of layer."""

from motiondiffuse_ros.diffusion.config import DenoiserConfig

SMALL = DenoiserConfig(
    width=32,
    layers=2,
    heads=4,
    ffn_width=32,
    head_width=16,
    time_width=32,
    text_width=32,
    text_layers=1,
    text_ffn_width=32,
    max_frames=64,
)
