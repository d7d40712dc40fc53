"""The plan of the next moment: sampled offsets of the targets, improved over a short horizon."""

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from motiondiffuse_ros.motion.rotations import Array
from motiondiffuse_ros.physics.tracking.config import SamplingConfig
from motiondiffuse_ros.physics.tracking.cost import residuals, sensor_weights
from motiondiffuse_ros.physics.tracking.gauss_newton import (
    Quadratic,
    antithetic_directions,
    fit_quadratic,
)
from motiondiffuse_ros.physics.tracking.offsets import OffsetPath, corrected_hinges
from motiondiffuse_ros.physics.tracking.reference import Reference

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS

_SAMPLING_TIME = 0.05  # between two times at which the cost is taken [s]
_SPREADS = (1.0, 0.5)  # of the rounds in turn, in shares of the configured one
_LATE = 3  # of them at the end of the horizon count more


@dataclass(frozen=True, eq=False)
class _Simulated:
    """What n knots' values [n, K, D] lead to: residuals [n, R, F] and cost [n]."""

    values: Array = field(repr=False)
    residuals: Array = field(repr=False)
    costs: Array = field(repr=False)

    def best(self) -> tuple[Array, float]:
        index = int(np.argmin(self.costs))
        return self.values[index], float(self.costs[index])


class Lookahead:
    """Plans controls a horizon ahead, each plan from the one before."""

    def __init__(
        self, model: mujoco.MjModel, reference: Reference, config: SamplingConfig, pool: Rollout
    ) -> None:
        """Start without offsets.

        Args:
            model: What is simulated, by as many threads as `config` says.
            reference: At the model's time step.
            config: Valid.
            pool: Threads for the simulation.
        """
        self._model, self._reference, self._config, self._pool = model, reference, config, pool
        self._data = [mujoco.MjData(model) for _ in range(config.thread_count)]
        self._generator = np.random.default_rng(config.seed)
        step = model.opt.timestep
        self._steps = round(config.horizon / step)
        self._path = OffsetPath.over(config.knots, np.arange(self._steps) * step)
        every = round(_SAMPLING_TIME / step)
        self._seen = np.arange(every, self._steps + 1, every) - 1
        self._late = np.ones(len(self._seen))
        self._late[-_LATE:] = config.weights.late
        self._weights = sensor_weights(config.weights, model)
        self._hinges, self._scales = corrected_hinges()
        self._start = np.zeros(len(self._hinges))
        self._mean = np.zeros((len(config.knots), len(self._hinges)))
        self._root = np.eye(self._mean.size)

    def plan(self, state: Array, step: int) -> None:
        """Improve the plan by as many rounds as configured, and by more if it stays bad.

        Args:
            state: `STATE` of the body [n].
            step: Of the reference, at which it is in this state.
        """
        config = self._config
        for iteration in range(config.most_iterations):
            cost = self._improve(state, step, config.spread * _SPREADS[iteration % len(_SPREADS)])
            if iteration + 1 >= config.iterations and cost <= config.content:
                return

    def controls(self, step: int, count: int) -> Array:
        """Return the best plan's controls [count, 63] from a step on."""
        return self._controls(step, self._mean[None])[0, :count]

    def move_on(self, steps: int) -> None:
        """Let the horizon begin later."""
        by = steps * self._model.opt.timestep
        self._start, self._mean = self._path.moved_on(self._start, self._mean, by)

    def saved(self) -> tuple[Array, Array]:
        """Return the plan, for `restore`."""
        return self._start, self._mean

    def restore(self, saved: tuple[Array, Array]) -> None:
        """Go back to an earlier plan; samples will be others."""
        self._start, self._mean = saved

    def _improve(self, state: Array, step: int, spread: float) -> float:
        """Sample around the best plan, go to the best that is found, and return its cost."""
        shape, size = self._mean.shape, self._mean.size
        directions = antithetic_directions(self._generator, self._config.directions, size)
        moves = spread * directions @ self._root
        values = self._mean + np.concatenate([np.zeros((1, size)), moves]).reshape(-1, *shape)
        sampled = self._simulate(state, step, values)
        quadratic = self._fit(moves, sampled)
        steps = quadratic.steps().reshape(-1, *shape)
        stepped = self._simulate(state, step, self._mean + steps)
        self._mean, cost = min(sampled.best(), stepped.best(), key=lambda found: found[1])
        share = self._config.adaptation
        if share > 0.0:
            self._root = (1.0 - share) * np.eye(size) + share * quadratic.covariance_root()
        return cost

    def _fit(self, moves: Array, sampled: _Simulated) -> Quadratic:
        times = self._path.times[self._seen]
        return fit_quadratic(
            moves,
            sampled.residuals[1:] - sampled.residuals[0],
            sampled.residuals[0],
            [self._path.knots_before(time) * len(self._hinges) for time in times],
            sampled.values[0].ravel(),
            self._config.weights.offset**2,
        )

    def _simulate(self, state: Array, step: int, values: Array) -> _Simulated:
        states = np.broadcast_to(state, (len(values), len(state)))
        _, sensed = self._pool.rollout(
            self._model, self._data, states, self._controls(step, values)
        )
        rows = step + self._seen
        wanted = self._reference.sensed[np.minimum(rows, len(self._reference) - 1)]
        found = residuals(np.asarray(sensed)[:, self._seen], wanted, self._weights)
        # nothing is asked for beyond the end of the motion
        found *= (self._late * (rows < len(self._reference)))[:, None]
        offsets = self._config.weights.offset * values
        costs = np.sum(found**2, axis=(1, 2)) + np.sum(offsets**2, axis=(1, 2))
        return _Simulated(values, found, costs)

    def _controls(self, step: int, values: Array) -> Array:
        rows = np.minimum(step + np.arange(self._steps), len(self._reference) - 1)
        controls = np.repeat(self._reference.controls[None, rows], len(values), axis=0)
        controls[:, :, self._hinges] += self._scales * self._path.offsets(self._start, values)
        return controls
