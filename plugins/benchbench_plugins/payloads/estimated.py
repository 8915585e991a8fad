"""The mass of what hangs at the magnet, estimated from how the thrust falls short of what it should accelerate."""

from __future__ import annotations

from typing import final

from pydantic import validate_call

from benchbench.flight.payload import Payload, Weighing
from benchbench.flight.rig import Rig
from benchbench.flight.sensed import Command, Sensed
from benchbench.ocp.scenario import Positive
from benchbench.ocp.task_family import Chance


@final
class Estimated(Payload):
    """Integrates the acceleration along the body's z axis that was not expected, while the ball is attached.

    F = (m + m_b) c: a model with the mass m + m_b expects F / (m + m_b); falling short by r, m_b is too small by about
    (m + m_b)^2 r / F.
    """

    @validate_call
    def __init__(self, gain: Chance = 0.15, most: Positive = 1.0) -> None:
        """gain: share of a shortfall that is believed; most: kg, no estimate is larger."""
        self.gain, self.most = gain, most

    def prepare(self, rig: Rig, vehicle_mass: float) -> Weighing:
        """Begin at 0 kg."""
        return _Scales(self.gain, self.most, vehicle_mass).weigh


class _Scales:
    def __init__(self, gain: float, most: float, vehicle_mass: float) -> None:
        self.gain, self.most, self.vehicle, self.mass = gain, most, vehicle_mass, 0.0

    def weigh(self, sensed: Sensed, command: Command | None, along: float) -> float:
        if not sensed.attached or command is None:
            self.mass = 0.0 if not sensed.attached else self.mass
            return self.mass
        change = -((self.vehicle + self.mass) ** 2) * along / max(command.thrust, 1.0)
        self.mass = min(max(self.mass + self.gain * change, 0.0), self.most)
        return self.mass
