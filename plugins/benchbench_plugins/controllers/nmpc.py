"""Nonlinear model predictive control of the paper (Sec. V), one Newton step for each command (real-time iteration)."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

import numpy as np

from benchbench.arrays import Array, Index
from benchbench.flight.controller import Controller, Known
from benchbench.flight.extra import need
from benchbench.flight.payload import Weighing
from benchbench.flight.residual import Correction
from benchbench.flight.sensed import Command, Sensed
from benchbench_plugins.controllers.condensed import Condensed, Weights
from benchbench_plugins.controllers.estimate import Estimate
from benchbench_plugins.controllers.prediction import Prediction
from benchbench_plugins.controllers.tables import GRID, Tables, tables
from benchbench_plugins.controllers.telling import Telling


@final
class Nmpc(Controller):
    """Diehl, Bock & Schloeder 2005 (doi:10.1137/S0363012902400713), states condensed, the program solved by daqp.

    stages, step           20 steps of 50 ms look ahead for a second
    position .. thrust     weights of the errors, in 1 over SI units squared
    latency                s from a command until it works, of motors and rate loop (a guess, whatever the world)
    lead                   s by which thrust and torques of the reference are told early
    rate_limit             rad/s, largest body rates that are asked for
    soft_speed             share by which the vehicle's speed limits may be exceeded before that costs; 0 for no such bound
    """

    def __init__(
        self, stages: int = 20, step: float = 0.05, position: float = 200.0, attitude: float = 5.0,
        velocity: float = 5.0, rates: float = 1.0, thrust: float = 0.1, rate_limit: tuple[float, ...] = (6.0, 6.0, 3.0),
        soft_speed: float = 0.1, latency: float = 0.03, lead: float = 0.012,
    ) -> None:  # fmt: skip
        """Keep the numbers. Raises Unavailable without daqp."""
        need("daqp", "controller=nmpc")
        self.stages, self.step, self.rate_limit, self.soft_speed = stages, step, rate_limit, soft_speed
        self.latency, self.lead = latency, lead
        self.weights = Weights(position, attitude, velocity, rates, thrust)

    def prepare(
        self, known: Known, correction: Correction, weighing: Weighing
    ) -> Callable[[Sensed, float], Command]:
        """Tabulate the reference and build the prediction."""
        frame, most = known.airframe, np.array(known.rig.motor_force) * 4 / known.airframe.total_mass
        prediction = Prediction(frame.gravity, self.step, self.stages)
        speed = np.array(frame.speed) * (1 + self.soft_speed) if self.soft_speed > 0 else None
        limit = np.array(self.rate_limit)
        program = Condensed(
            prediction, self.weights, np.append(-limit, most[0]), np.append(limit, most[1]), speed
        )
        table = tables(known.reference, frame, self.step)
        estimate = Estimate(table, known, correction, weighing, self.latency)
        return _Running(
            program, table, estimate, Telling(known, table, self.lead), correction, self.step
        ).command


class _Running:
    """The controller in one flight; remembers the inputs of the last command."""

    def __init__(
        self, program: Condensed, table: Tables, estimate: Estimate, telling: Telling, correction: Correction, step: float
    ) -> None:  # fmt: skip
        self.program, self.table, self.estimate, self.telling = program, table, estimate, telling
        self.correction, self.step = correction, step
        self.stride, n = round(step / GRID), program.stages
        self.change, self.asked, self.nodes = np.zeros((n, 4)), -np.inf, np.zeros((0, 10))

    def command(self, sensed: Sensed, now: float) -> Command:
        """Estimate, predict, solve, tell."""
        table, program = self.table, self.program
        state, payload = self.estimate.ahead(sensed, now)
        rows = np.minimum(
            table.row(now + self.estimate.latency) + self.stride * np.arange(program.stages + 1),
            len(table.state) - 1,
        )
        wanted = table.inputs[rows[:-1]]
        inputs = np.clip(wanted + self._shifted(now), program.low[:4], program.high[:4])
        offset, by_state = self._residual(rows, state, payload)
        program.prediction.run(state, inputs, table.offset[rows[:-1]] + offset)
        if by_state is not None:
            program.prediction.by_state[:] += by_state
        found = program.solve(table.state[rows[1:]], wanted, table.error[rows[1:]])
        self.change, self.asked, self.nodes = found - wanted, now, program.prediction.after.copy()
        command = self.telling.command(now, self.change[0], payload)
        self.estimate.told(command, self.change[0])
        return command

    def _shifted(self, now: float) -> Array:
        """What was added to the reference's inputs, moved on by the time since then."""
        share = min((now - self.asked) / self.step, 1.0)
        later = np.vstack([self.change[1:], self.change[-1:]])
        return (1 - share) * self.change + share * later

    def _residual(self, rows: Index, state: Array, payload: float) -> tuple[Array, Array | None]:
        """Offsets (stages, 10) of the residual acceleration and a payload (kg), held for each stage, and their share of dx+/dx."""
        nodes = self.table.state[rows[:-1]]
        if len(self.nodes):
            nodes = np.vstack([state, self.nodes[:-1]])
        pushed, gradient = self.correction.predict(nodes, self.table.arm[rows[:-1]])
        pushed = pushed + payload / (self.estimate.mass + payload) * self.table.stage_apart[rows[:-1]]
        h = self.step
        offset = np.zeros((len(pushed), 10))
        offset[:, :3], offset[:, 7:] = h * h / 2 * pushed, h * pushed
        if gradient is None:
            return offset, None
        added = np.zeros((len(pushed), 10, 10))
        added[:, :3], added[:, 7:] = h * h / 2 * gradient, h * gradient
        return offset, added
