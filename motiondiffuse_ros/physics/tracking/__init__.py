"""Can a body do it? Motions followed in simulation, with nothing that holds the root.

`track` is a PD controller without any balance: cheap, and enough to rank. `track_by_sampling`
looks ahead and corrects, and yields what a body would do instead of the drawn motion.
"""

from motiondiffuse_ros.physics.tracking.config import SamplingConfig
from motiondiffuse_ros.physics.tracking.execution import Execution
from motiondiffuse_ros.physics.tracking.pd import Tracking, track
from motiondiffuse_ros.physics.tracking.reference import FALL_DISTANCE
from motiondiffuse_ros.physics.tracking.sampling import track_by_sampling

__all__ = [
    "FALL_DISTANCE",
    "Execution",
    "SamplingConfig",
    "Tracking",
    "track",
    "track_by_sampling",
]
