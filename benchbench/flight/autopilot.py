"""An autopilot: body rates and thrust become motor forces, five hundred times a second."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from benchbench.flight.controller import Known
from benchbench.flight.sensed import Command, Triple
from benchbench.ground.arrays import Array


class Autopilot(ABC):
    """Follows body rates."""

    @abstractmethod
    def prepare(self, known: Known) -> Callable[[Command, float, Triple], Array]:
        """Return a step, called every `STEP` s with the command, the time now and the gyro's rates rad/s.

        It returns motor forces (4,) N within the rig's limits. At first the vehicle hovers at the reference's first state.
        """
