"""Motions followed on their own feet, by sampling what to correct over a short horizon."""

from __future__ import annotations

import time
from collections.abc import Callable

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from motiondiffuse_ros.errors import Cancelled
from motiondiffuse_ros.motion import Motion
from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.state import qpos_to_motion
from motiondiffuse_ros.physics.tracking.config import SamplingConfig
from motiondiffuse_ros.physics.tracking.execution import Execution
from motiondiffuse_ros.physics.tracking.lookahead import Lookahead
from motiondiffuse_ros.physics.tracking.model import tracking_model
from motiondiffuse_ros.physics.tracking.plant import Plant
from motiondiffuse_ros.physics.tracking.reference import check_trackable, make_reference

_BACK = 6  # plans that the search takes back at first


def track_by_sampling(
    motion: Motion,
    config: SamplingConfig | None = None,
    *,
    cancelled: Callable[[], bool] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Execution:
    """Execute a motion in simulation without assistance.

    Receding horizon: from the present state, random offsets of the PD controller's targets are
    simulated ahead, the offsets that come nearest to the motion are found and executed for a
    moment; a search that lost the body goes back in time (docs/tracking.md). The same motion,
    configuration and machine give the same result, whatever the number of threads.

    Args:
        motion: 0.1 s or more, floor at z = 0.
        config: Settings; the defaults if None.
        cancelled: Asked before every plan.
        progress: Told the share done, 0 to 1, after every plan.

    Raises:
        PhysicsError: If the motion is too short or not finite, or the settings are invalid.
        Cancelled: If `cancelled` says so.
    """
    began = time.perf_counter()
    config = config or SamplingConfig()
    config.validate()
    check_trackable(motion)
    model = tracking_model()
    reference = make_reference(motion, model)
    plant = Plant(model, reference)
    steps = max(1, round(config.interval / model.opt.timestep))
    with Rollout(nthread=config.thread_count) as pool:
        search = _Search(plant, Lookahead(model, reference, config, pool), config)
        furthest = 0
        while not plant.stopped:
            if cancelled is not None and cancelled():
                raise Cancelled("tracking was cancelled")
            search.advance(steps)
            furthest = max(furthest, plant.step)
            if progress is not None:
                progress(furthest / (len(reference) - 1))
    return _summary(motion, plant, model, time.perf_counter() - began)


class _Search:
    """Advances plan by plan, and goes back some of them where that ends in a fall."""

    def __init__(self, plant: Plant, lookahead: Lookahead, config: SamplingConfig) -> None:
        self._plant, self._lookahead, self._config = plant, lookahead, config
        self._history: list[tuple[tuple[int, Array], tuple[Array, Array]]] = []
        self._retries = 0

    def advance(self, steps: int) -> None:
        """Plan, and execute the first steps of the plan."""
        plant, lookahead = self._plant, self._lookahead
        self._history.append((plant.saved(), lookahead.saved()))
        lookahead.plan(plant.state, plant.step)
        plant.execute(lookahead.controls(plant.step, steps))
        lookahead.move_on(steps)
        lost = plant.diverged or plant.error > self._config.lost
        if lost and self._retries < self._config.retries:
            self._go_back()

    def _go_back(self) -> None:
        """Return to a state before things went wrong, further back the more often they do."""
        self._retries += 1
        back = min(_BACK * (1 + self._retries // 2), len(self._history))
        saved, plan = self._history[-back]
        del self._history[-back:]
        self._plant.restore(saved)
        self._lookahead.restore(plan)


def _summary(motion: Motion, plant: Plant, model: mujoco.MjModel, seconds: float) -> Execution:
    record, rate = plant.record, 1.0 / model.opt.timestep
    up = not (plant.fallen or plant.diverged)
    errors = 1000.0 * np.array(record.errors)
    qpos = np.array(record.qpos)
    return Execution(
        motion=qpos_to_motion(qpos, rate).resample(motion.fps),
        success=up,
        diverged=plant.diverged,
        time_to_fall=motion.duration if up else plant.step / rate,
        mpjpe=float(errors.mean()),
        mpjpe_local=1000.0 * float(np.mean(record.local_errors)),
        largest_error=float(errors.mean(axis=1).max()),
        rate=rate,
        qpos=qpos,
        torques=np.array(record.torques),
        contact_forces=np.array(record.forces),
        seconds=seconds,
    )
