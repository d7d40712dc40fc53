"""How tracking by sampling looks ahead, what it draws and what it weighs."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

from motiondiffuse_ros.errors import PhysicsError


@dataclass(frozen=True)
class CostWeights:
    """Weights of the residuals whose squares are summed over the horizon.

    Attributes:
        joints: Positions of the joints, per metre.
        feet: Positions of ankles and toes instead, per metre.
        centre: Position of the centre of mass, per metre.
        velocity: Its velocity, per m/s.
        momentum: Angular momentum about it, per kg m^2/s.
        orientation: Of the root, per radian.
        late: Factor on all of them in the last 0.15 s of the horizon.
        offset: Offsets of the controller's targets, per unit of their scale.
    """

    joints: float = 0.4
    feet: float = 0.6
    centre: float = 6.0
    velocity: float = 2.0
    momentum: float = 0.08
    orientation: float = 5.0
    late: float = 2.0
    offset: float = 0.3


@dataclass(frozen=True)
class SamplingConfig:
    """Settings of `track_by_sampling`.

    Attributes:
        horizon: How far ahead it simulates, s.
        interval: Time between two plans, s.
        knots: Times in the horizon at which the offsets of the targets are free, linear between
            them and constant after the last, s.
        directions: Random directions of offsets, each simulated forwards and backwards.
        iterations: Rounds of sampling a plan, each around the best of the round before.
        most_iterations: Rounds where the plan is still bad after that.
        content: Cost above which a plan is bad.
        spread: Size of the samples in the first round, in units of the offsets' scales; half of
            it in the next, and so on in turn.
        adaptation: How far the samples' covariance follows the inverse curvature of the cost
            found in the round before, 0 (not at all) to 1.
        retries: How often the search may go back to an earlier state and try other samples,
            once the body is lost.
        lost: Mean distance of the joints from the reference at which it is, m.
        weights: Of the cost.
        seed: Of the directions.
        threads: Of the simulation; None is one a core. They do not change the result.
    """

    horizon: float = 0.5
    interval: float = 0.1
    knots: tuple[float, ...] = (0.1, 0.2, 0.35)
    directions: int = 58
    iterations: int = 2
    most_iterations: int = 4
    content: float = 6.0
    spread: float = 0.1
    adaptation: float = 0.0
    retries: int = 6
    lost: float = 0.3
    weights: CostWeights = field(default_factory=CostWeights)
    seed: int = 0
    threads: int | None = None

    def validate(self) -> None:
        """Raise PhysicsError if a value is out of range."""
        if not 0.0 < self.interval <= self.horizon <= 2.0:
            raise PhysicsError(
                f"0 < interval <= horizon <= 2 s must hold, got {self.interval}, {self.horizon}"
            )
        rising = all(a < b for a, b in zip((0.0, *self.knots), self.knots, strict=False))
        if not self.knots or not rising or self.knots[-1] > self.horizon:
            raise PhysicsError(f"knots must rise from above 0 to the horizon, got {self.knots}")
        for name in ("directions", "iterations"):
            if getattr(self, name) < 1:
                raise PhysicsError(f"{name} must be 1 or more, got {getattr(self, name)}")
        if self.most_iterations < self.iterations or self.retries < 0:
            raise PhysicsError(
                "most_iterations must be iterations or more and retries 0 or more, "
                f"got {self.most_iterations}, {self.retries}"
            )
        if not (self.content >= 0.0 and self.lost > 0.0):
            raise PhysicsError(
                f"content must be 0 or more and lost above 0 m, got {self.content}, {self.lost}"
            )
        if not self.spread > 0.0 or not 0.0 <= self.adaptation <= 1.0:
            raise PhysicsError(
                "spread must be above 0 and adaptation from 0 to 1, "
                f"got {self.spread}, {self.adaptation}"
            )
        if self.threads is not None and self.threads < 1:
            raise PhysicsError(f"threads must be 1 or more, got {self.threads}")

    @property
    def thread_count(self) -> int:
        """Threads of the simulation."""
        return self.threads or os.cpu_count() or 1
