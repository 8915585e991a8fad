"""PX4's rate loop; torques that the plan needs are left to its integral, or fed forward (conf/autopilot/torque_ff.yaml)."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

from pydantic import validate_call

from benchbench.flight.autopilot import Autopilot
from benchbench.flight.controller import Known
from benchbench.flight.sensed import Command, Triple
from benchbench.ground.arrays import Array
from benchbench.ocp.scenario import NonNegative
from benchbench.ocp.task_family import Chance
from benchbench_plugins.autopilots.rate_loop import Gains, RateLoop

Axes = tuple[NonNegative, NonNegative, NonNegative]


@final
class Px4(Autopilot):
    """PX4's rate controller: proportional and integral terms, times the inertia, and a mixer that gives up yaw first.

    proportional, integral, derivative  gains about x, y and z, 1/s, 1/s^2 and 1
    forward                             share of the torques that the plan (and a payload) needs by themselves which is added
    """

    @validate_call
    def __init__(
        self, proportional: Axes = (20.0, 20.0, 10.0), integral: Axes = (60.0, 60.0, 10.0),
        derivative: Axes = (0.8, 0.8, 0.0), forward: Chance = 0.0,
    ) -> None:  # fmt: skip
        """Keep the numbers."""
        self.forward = forward
        self.gains = Gains(proportional, integral, derivative)

    def prepare(self, known: Known) -> Callable[[Command, float, Triple], Array]:
        """Begin with an integral that holds the arm."""
        return RateLoop(known, self.gains, self.forward).motors
