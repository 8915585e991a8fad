"""The same predictive control solved to convergence by IPOPT: what the real-time iteration is checked against."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

from pydantic import validate_call

from benchbench.flight.controller import Controller, Known
from benchbench.flight.payload import Weighing
from benchbench.flight.residual import Correction
from benchbench.flight.sensed import Command, Sensed
from benchbench.ground.arrays import Array
from benchbench.ocp.scenario import NonNegative, Positive
from benchbench.ocp.task_family import Chance
from benchbench_plugins.controllers.condensed import Weights
from benchbench_plugins.controllers.converged import Converged
from benchbench_plugins.controllers.prediction import Prediction
from benchbench_plugins.controllers.receding import Horizon, Stages, receding
from benchbench_plugins.controllers.tables import Ahead, Stage


@final
class NmpcIpopt(Controller):
    """As `nmpc`, without the bound on speeds and the residual's gradient; some ten times slower, so for checks alone."""

    @validate_call
    def __init__(
        self, stages: Stages = 20, step: Stage = 0.05, position: Positive = 400.0, attitude: Positive = 5.0,
        velocity: Positive = 10.0, rates: Positive = 1.0, thrust: Positive = 0.1, rate_limit: tuple[Positive, Positive, Positive] = (6.0, 6.0, 3.0),
        latency: Ahead = 0.03, lead: Ahead = 0.012, tip: NonNegative = 45.0, aside: Chance = 0.5,
    ) -> None:  # fmt: skip
        """Keep the numbers; they mean what they do for `nmpc`."""
        self.horizon = Horizon(stages, step, latency, lead, rate_limit, aside)
        self.weights = Weights(position, attitude, velocity, rates, thrust, tip)

    def prepare(
        self, known: Known, correction: Correction, weighing: Weighing
    ) -> Callable[[Sensed, float], Command]:
        """Build the nonlinear program."""
        gravity = known.airframe.gravity

        def program(prediction: Prediction, low: Array, high: Array) -> Converged:
            return Converged(prediction, self.weights, low, high, gravity, self.horizon.step)

        return receding(known, correction, weighing, self.horizon, program)
