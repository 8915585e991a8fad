"""What hangs at the magnet, as the controller knows it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from benchbench.flight.rig import Rig
from benchbench.flight.sensed import Command, Sensed

Weighing = Callable[[Sensed, Command | None, float], float]
"""From what is sensed, the last command, and an acceleration (m/s^2), the mass in kg.

The acceleration is that along the body's z axis which was not expected, beyond what a residual model expected before the ball hung
there: what such a model has learned since then is the mass's.
"""


class Payload(ABC):
    """Tells the mass that the vehicle carries beside itself."""

    @abstractmethod
    def prepare(self, rig: Rig, vehicle_mass: float) -> Weighing:
        """Return how one flight weighs what it carries; vehicle_mass in kg."""
