"""Nonlinear model predictive control of the paper (Sec. V), one Newton step for each command (real-time iteration)."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

import numpy as np
from pydantic import validate_call

from benchbench.flight.controller import Controller, Known
from benchbench.flight.extra import need
from benchbench.flight.payload import Weighing
from benchbench.flight.residual import Correction
from benchbench.flight.sensed import Command, Sensed
from benchbench.ground.arrays import Array
from benchbench.ocp.scenario import NonNegative, Positive
from benchbench.ocp.task_family import Chance
from benchbench_plugins.controllers.condensed import Condensed, Weights
from benchbench_plugins.controllers.prediction import Prediction
from benchbench_plugins.controllers.receding import Horizon, Stages, receding
from benchbench_plugins.controllers.tables import Ahead, Stage


@final
class Nmpc(Controller):
    """Diehl, Bock & Schloeder 2005 (doi:10.1137/S0363012902400713), states condensed, the program solved by daqp.

    stages, step           20 steps of 50 ms look ahead for a second
    position .. thrust     weights of the errors, in 1 over SI units squared
    tip                    weight of the error of the end effector's velocity while the ball is near: the judge's 0.15 m/s cost 1
    latency                s from a command until it works, of motors and rate loop (a guess, whatever the world)
    lead                   s by which thrust and torques of the reference are told early
    rate_limit             rad/s, largest body rates that are asked for
    aside                  share of the room between the edge and the depth of the magnet's reach by which the vehicle keeps from the ball
    soft_speed             share by which the vehicle's speed limits may be exceeded before that costs; 0 for no such bound
    """

    @validate_call
    def __init__(
        self, stages: Stages = 20, step: Stage = 0.05, position: Positive = 400.0, attitude: Positive = 5.0,
        velocity: Positive = 10.0, rates: Positive = 1.0, thrust: Positive = 0.1, rate_limit: tuple[Positive, Positive, Positive] = (6.0, 6.0, 3.0),
        soft_speed: NonNegative = 0.1, latency: Ahead = 0.03, lead: Ahead = 0.012, tip: NonNegative = 45.0, aside: Chance = 0.5,
    ) -> None:  # fmt: skip
        """Keep the numbers. Raises Unavailable without daqp."""
        need("daqp", "controller=nmpc")
        self.horizon, self.soft_speed = Horizon(stages, step, latency, lead, rate_limit, aside), soft_speed
        self.weights = Weights(position, attitude, velocity, rates, thrust, tip)

    def prepare(
        self, known: Known, correction: Correction, weighing: Weighing
    ) -> Callable[[Sensed, float], Command]:
        """Tabulate the reference and build the prediction."""
        fastest = np.array(known.airframe.speed) * (1 + self.soft_speed) if self.soft_speed > 0 else None

        def program(prediction: Prediction, low: Array, high: Array) -> Condensed:
            return Condensed(prediction, self.weights, low, high, fastest)

        return receding(known, correction, weighing, self.horizon, program)
