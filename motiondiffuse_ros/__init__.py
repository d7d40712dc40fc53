"""Words to physics-checked joint trajectories on ROS 2, by motion diffusion."""

__version__ = "0.1.0"
