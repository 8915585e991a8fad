"""From a change of the model's inputs to a command: the reference goes on between commands, the change is held."""

from __future__ import annotations

from typing import final

import numpy as np

from benchbench.flight.controller import PERIOD, Known
from benchbench.flight.reference import matrices
from benchbench.flight.sensed import Command, Triple
from benchbench.ground.arrays import Array
from benchbench_plugins.controllers.tables import Tables


@final
class Telling:
    """Of one flight."""

    def __init__(self, known: Known, table: Tables, lead: float) -> None:
        """Keep the reference; lead: s by which thrust and torques are told early, since motors lag."""
        self.lead = lead
        self.reference, self.table, self.frame = known.reference, table, known.airframe
        self.span = round(PERIOD / known.reference.step)

    def command(self, now: float, change: Array, payload: float) -> Command:
        """Return the command for the time from now on; change (4,) of rates rad/s and thrust over mass; payload in kg."""
        r, row, early = self.reference, self.reference.row(now), self.reference.row(now + self.lead)
        later = min(row + self.span, len(r.time) - 1)
        state, after = r.state[row], r.state[later]
        soon = r.state[min(early + self.span, len(r.time) - 1)]
        spin = (soon[11:14] - r.state[early, 11:14]) / PERIOD
        wrench = self.table.wrench[early : early + self.span].mean(axis=0)
        mass = self.frame.total_mass
        thrust = (wrench[0] / mass + change[3]) * (mass + payload)
        load, joint = self._load(early, float(state[7]), payload)
        torque = wrench[1:] + load
        servo = float(r.inputs[row : row + self.span, 4].mean()) + joint
        rate = (after[7] - state[7]) / PERIOD
        return Command(
            now, float(thrust), _triple(state[11:14] + change[:3]), _triple(spin), _triple(torque),
            (float(state[7]), float(rate), servo),
        )  # fmt: skip

    def _load(self, row: int, arm: float, payload: float) -> tuple[Array, float]:
        """Torques N m on the body (3,), and about the joint, that move a payload (kg) at the tip as the reference does."""
        if payload == 0.0:
            return np.zeros(3), 0.0
        pull = payload * self.table.tip[row : row + self.span].mean(axis=0)
        force = matrices(self.reference.state[row : row + 1, 3:7])[0].T @ pull
        x, z = self.frame.arm_length * np.cos(arm), -self.frame.arm_length * np.sin(arm)
        joint = float(z * force[0] - x * force[2])
        return np.cross([x, 0.0, z - self.frame.arm_offset], force), joint


def _triple(numbers: Array) -> Triple:
    x, y, z = np.asarray(numbers).tolist()
    return x, y, z
