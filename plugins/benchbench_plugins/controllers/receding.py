"""What predictive controllers share in a flight: estimate, predict, solve, tell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Protocol, final

import numpy as np
from pydantic import Field

from benchbench.flight.controller import Known
from benchbench.flight.payload import Weighing
from benchbench.flight.residual import Correction
from benchbench.flight.sensed import Command, Sensed
from benchbench.ground.arrays import Array, Index
from benchbench_plugins.controllers.estimate import Estimate
from benchbench_plugins.controllers.prediction import Prediction
from benchbench_plugins.controllers.tables import GRID, Tables, tables
from benchbench_plugins.controllers.telling import Telling

Stages = Annotated[int, Field(ge=1, le=200)]
"""Of a horizon; the work of a command grows with their third power."""


class Program(Protocol):
    """Finds the inputs of a horizon from a prediction that has been run along a guess."""

    prediction: Prediction
    stages: int
    low: Array
    high: Array

    def solve(self, state: Array, inputs: Array, error: Array, lever: Array) -> Array:
        """Return inputs (stages, 4) for the references of the stages' ends, see `Condensed.solve`."""


@dataclass(frozen=True)
class Horizon:
    """Stages of `step` s; latency, lead in s and aside as `Nmpc` has them; rate_limit (3,) rad/s."""

    stages: int
    step: float
    latency: float
    lead: float
    rate_limit: tuple[float, ...]
    aside: float


def receding(
    known: Known, correction: Correction, weighing: Weighing, horizon: Horizon,
    program: Callable[[Prediction, Array, Array], Program],
) -> Callable[[Sensed, float], Command]:  # fmt: skip
    """Return the step of a controller; program: made of a prediction and the bounds (4,) of its inputs."""
    frame, most = known.airframe, np.array(known.rig.motor_force) * 4 / known.airframe.total_mass
    table = tables(known.reference, frame, horizon.step, horizon.aside)
    estimate = Estimate(table, known, correction, weighing, horizon.latency, horizon.lead)
    telling = Telling(known, table, horizon.lead)
    if isinstance(known.before, Receding):
        return known.before.onto(table, estimate, telling)
    prediction = Prediction(frame.gravity, horizon.step, horizon.stages)
    limit = np.array(horizon.rate_limit)
    made = program(prediction, np.append(-limit, most[0]), np.append(limit, most[1]))
    return Receding(made, table, estimate, telling, correction, horizon.step)


@final
class Receding:
    """The controller in one flight; remembers the inputs of the last command."""

    def __init__(
        self, program: Program, table: Tables, estimate: Estimate, telling: Telling, correction: Correction, step: float
    ) -> None:  # fmt: skip
        """Begin on the reference."""
        self.program, self.table, self.estimate, self.telling = program, table, estimate, telling
        self.correction, self.step = correction, step
        self.stride, n = round(step / GRID), program.stages
        self.change, self.asked, self.nodes = np.zeros((n, 4)), -np.inf, np.zeros((0, 10))

    def onto(self, table: Tables, estimate: Estimate, telling: Telling) -> Receding:
        """Return the same with another reference: its program, the last inputs, and all that was learned and told."""
        other = Receding(self.program, table, estimate, telling, self.correction, self.step)
        other.change, other.asked, other.nodes = self.change, self.asked, self.nodes
        estimate.remember(self.estimate)
        return other

    def __call__(self, sensed: Sensed, now: float) -> Command:
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
        found = program.solve(table.state[rows[1:]], wanted, table.error[rows[1:]], table.lever[rows[1:]])
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
