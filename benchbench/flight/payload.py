"""What hangs at the magnet, as the controller knows it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from benchbench.flight.rig import Rig
from benchbench.flight.sensed import Command, Sensed

Weighing = Callable[[Sensed, Command | None, float], float]
"""From what is sensed, the last command, and the acceleration along the body's z axis that was not expected (m/s^2), kg."""


class Payload(ABC):
    """Tells the mass that the vehicle carries beside itself."""

    @abstractmethod
    def prepare(self, rig: Rig, vehicle_mass: float) -> Weighing:
        """Return how one flight weighs what it carries; vehicle_mass in kg."""
