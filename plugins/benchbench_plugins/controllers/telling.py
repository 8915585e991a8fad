"""From a change of the model's inputs to a command: the reference goes on between commands, the change is held."""

from __future__ import annotations

from typing import final

import numpy as np

from benchbench.arrays import Array
from benchbench.flight.controller import PERIOD, Known
from benchbench.flight.sensed import Command, Triple
from benchbench.flight.statics import arm_moment
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
        held, empty = (arm_moment(self.frame, float(state[7]), kg) for kg in (payload, 0.0))
        torque = wrench[1:] + np.array([0.0, held[1] - empty[1], 0.0])
        servo = float(r.inputs[row : row + self.span, 4].mean()) + held[0] - empty[0]
        rate = (after[7] - state[7]) / PERIOD
        return Command(
            now, float(thrust), _triple(state[11:14] + change[:3]), _triple(spin), _triple(torque),
            (float(state[7]), float(rate), servo),
        )  # fmt: skip


def _triple(numbers: Array) -> Triple:
    x, y, z = np.asarray(numbers).tolist()
    return x, y, z
