"""The rate loop with the plan's body torques fed forward."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

from benchbench.arrays import Array
from benchbench.flight.autopilot import Autopilot
from benchbench.flight.controller import Known
from benchbench.flight.sensed import Command, Triple
from benchbench_plugins.autopilots.rate_loop import Gains, RateLoop


@final
class TorqueFf(Autopilot):
    """PX4's rate controller, and the torques that the plan (and a payload) needs by themselves added to its own."""

    def __init__(
        self, proportional: tuple[float, ...] = (20.0, 20.0, 10.0), integral: tuple[float, ...] = (60.0, 60.0, 10.0),
        derivative: tuple[float, ...] = (0.8, 0.8, 0.0),
    ) -> None:  # fmt: skip
        """Gains about x, y and z, 1/s, 1/s^2 and 1."""
        self.gains = Gains(tuple(proportional), tuple(integral), tuple(derivative))

    def prepare(self, known: Known) -> Callable[[Command, float, Triple], Array]:
        """With the plan's torques."""
        return RateLoop(known, self.gains, 1.0).motors
