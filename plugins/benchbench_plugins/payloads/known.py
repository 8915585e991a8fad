"""The mass of the ball is known, and that it hangs there is felt by the magnet's switch."""

from __future__ import annotations

from typing import final

from benchbench.flight.payload import Payload, Weighing
from benchbench.flight.rig import Rig


@final
class Known(Payload):
    """Tells the rig's ball mass as soon as the ball is attached."""

    def prepare(self, rig: Rig, vehicle_mass: float) -> Weighing:
        """Nothing or the ball."""
        return lambda sensed, command, along: rig.ball_mass if sensed.attached else 0.0
