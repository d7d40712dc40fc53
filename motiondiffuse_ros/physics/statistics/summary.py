"""All statistics of a motion."""

from __future__ import annotations

from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.physics.body_states import BodyStates
from motiondiffuse_ros.physics.dynamics import Dynamics
from motiondiffuse_ros.physics.statistics.effort import effort
from motiondiffuse_ros.physics.statistics.footing import footing
from motiondiffuse_ros.physics.statistics.frames import from_root
from motiondiffuse_ros.physics.statistics.gait import gait
from motiondiffuse_ros.physics.statistics.ground_plane import ground_plane
from motiondiffuse_ros.physics.statistics.posture import posture
from motiondiffuse_ros.physics.statistics.stillness import stillness
from motiondiffuse_ros.physics.statistics.tempo import tempo


def statistics(motion: Motion, states: BodyStates, dynamics: Dynamics) -> dict[str, float]:
    """Return every statistic by name.

    Args:
        motion: At 20 fps, five frames or more.
        states: Of the humanoid that performs it.
        dynamics: Of those states.
    """
    local = from_root(motion)
    return {
        **footing(states),
        **posture(motion, states, dynamics),
        **effort(states, dynamics),
        **tempo(motion, states, local),
        **gait(motion, states, dynamics, local),
        **ground_plane(motion, states, dynamics),
        **stillness(states, dynamics),
    }
