"""Starts and trajectories as arrays by name, exact to the last bit, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields

import numpy as np

from motiondiffuse_ros.continuation import Start
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.robots import JointTrajectory, StartState
from motiondiffuse_ros.robots.start_state import RootState

Arrays = Mapping[str, Array]

TRAJECTORY = (
    *("times", "positions", "velocities", "accelerations"),
    *("root_position", "root_orientation", "root_linear_velocity", "root_angular_velocity"),
)
"""Arrays of a trajectory; `accelerations` may be missing."""


def of_trajectory(trajectory: JointTrajectory) -> dict[str, Array]:
    """Return the arrays of a trajectory."""
    found = {name: getattr(trajectory, name) for name in TRAJECTORY}
    return {name: values for name, values in found.items() if values is not None}


def of_state(state: StartState) -> dict[str, Array]:
    """Return the arrays of a robot's state."""
    arrays = {"positions": state.positions, "velocities": state.velocities}
    if state.root is not None:
        arrays |= {f"root/{f.name}": getattr(state.root, f.name) for f in fields(RootState)}
    return arrays


def to_state(arrays: Arrays) -> StartState:
    """Return a robot's state; KeyError if an array is missing."""
    root = within("root", arrays)
    return StartState(
        arrays["positions"],
        arrays["velocities"],
        RootState(**{f.name: root[f.name] for f in fields(RootState)}) if root else None,
    )


def of_start(start: Start) -> dict[str, Array]:
    """Return the arrays of a start; none for one over the origin."""
    arrays: dict[str, Array] = {}
    if start.lead_in is not None:
        motion = start.lead_in
        arrays |= {"lead_in/root": motion.root, "lead_in/rotations": motion.rotations}
        arrays["lead_in/fps"] = np.array([motion.fps], dtype=float)
    if start.state is not None:
        arrays |= under("state", of_state(start.state))
    return arrays


def to_start(arrays: Arrays) -> Start:
    """Return a start; KeyError if an array is missing, ValueError if one is of no motion."""
    motion, state = within("lead_in", arrays), within("state", arrays)
    lead_in = None
    if motion:
        lead_in = Motion(motion["root"], motion["rotations"], float(motion["fps"][0]))
    return Start(lead_in, to_state(state) if state else None)


def under(name: str, arrays: Arrays) -> dict[str, Array]:
    """Return arrays with a name before theirs."""
    return {f"{name}/{key}": values for key, values in arrays.items()}


def within(name: str, arrays: Arrays) -> dict[str, Array]:
    """Return the arrays that `under` put there, by their own names."""
    start = f"{name}/"
    return {key[len(start) :]: v for key, v in arrays.items() if key.startswith(start)}
