"""What the air does to a vehicle: drag, wind, gusts, and more thrust near the ground."""

from __future__ import annotations

from typing import final

from benchbench.flight.mismatch import Drawn
from benchbench.ground.arrays import Array

ROTOR = 0.12
"""m, radius of a rotor (chosen: 9.5 inch propellers of a frame of 0.33 m)."""
LOWEST = 0.1
"""m, below which ground effect grows no further."""


@final
class Surroundings:
    """Forces of one flight on the vehicle's centre; the gust begins some time before the planned contact."""

    def __init__(self, mismatch: Drawn, contact: float) -> None:
        """Keep the numbers as floats."""
        self.drag, self.ground = mismatch.drag, mismatch.ground_effect * (ROTOR / 4) ** 2
        self.wind, self.gust = mismatch.wind.tolist(), mismatch.gust.tolist()
        self.begins = contact - mismatch.gust_before
        self.ends = self.begins + mismatch.gust_seconds

    def force(self, time: float, velocity: Array, height: float, thrust: float) -> tuple[float, float, float]:
        """Return the force N in the world for a velocity (3 or more,) m/s, a height m and a thrust N."""
        blowing = 1.0 if self.begins <= time < self.ends else 0.0
        x, y = (w + blowing * g for w, g in zip(self.wind, self.gust, strict=True))
        lift = self.ground / max(height, LOWEST) ** 2 * thrust
        drag = self.drag
        return x - drag * float(velocity[0]), y - drag * float(velocity[1]), lift - drag * float(velocity[2])
