"""What hangs at the magnet is not thought of."""

from __future__ import annotations

from typing import final

from benchbench.flight.payload import Payload, Weighing
from benchbench.flight.rig import Rig


@final
class Ignored(Payload):
    """Tells 0 kg."""

    def prepare(self, rig: Rig, vehicle_mass: float) -> Weighing:
        """Nothing."""
        return lambda sensed, command, along: 0.0
