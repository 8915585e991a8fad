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
    """The mean of what the acceleration along the body's z axis that was not expected says, while the ball is attached.

    F = (m + m_b) c: a model with the mass m + m_b expects F / (m + m_b); falling short by r, m_b is too small by about
    (m + m_b)^2 r / F. Each reading is between nothing and `most`, whatever a ball that hits the magnet does. The first count alike, as
    for a constant; later ones count `gain`, so that what was wrong while the ball still swung is forgotten. Where nearly all that motors
    can give was commanded nothing is read: one of them at its limit gives less, which is no mass, and believing it would command more.
    """

    @validate_call
    def __init__(self, gain: Chance = 0.15, most: Positive = 1.0, throttle: Chance = 0.8) -> None:
        """gain: share of a reading that is believed at least; most: kg, no reading is larger; throttle: share of the thrust up to which is read."""
        self.gain, self.most, self.throttle = gain, most, throttle

    def prepare(self, rig: Rig, vehicle_mass: float) -> Weighing:
        """Begin at 0 kg."""
        return _Scales(self.gain, self.most, vehicle_mass, self.throttle * 4 * rig.motor_force[1]).weigh


class _Scales:
    def __init__(self, gain: float, most: float, vehicle_mass: float, fullest: float) -> None:
        self.gain, self.most, self.vehicle, self.fullest = gain, most, vehicle_mass, fullest
        self.mass, self.readings = 0.0, 0

    def weigh(self, sensed: Sensed, command: Command | None, along: float) -> float:
        if not sensed.attached:
            self.mass, self.readings = 0.0, 0
        elif command is not None and command.thrust <= self.fullest:
            change = -((self.vehicle + self.mass) ** 2) * along / max(command.thrust, 1.0)
            reading = min(max(self.mass + change, 0.0), self.most)
            self.readings += 1
            self.mass += max(self.gain, 1 / self.readings) * (reading - self.mass)
        return self.mass
