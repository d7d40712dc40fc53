"""A robot in MuJoCo that follows joint trajectories."""

from motiondiffuse_ros.robots.simulation.executed_motion import ExecutedMotion
from motiondiffuse_ros.robots.simulation.simulated_robot import SimulatedRobot, SimulationConfig

__all__ = ["ExecutedMotion", "SimulatedRobot", "SimulationConfig"]
