"""What tests of flights share: the vehicle, a rig, no mismatch."""

from __future__ import annotations

import numpy as np
from flights import table_one

from benchbench.flight.mismatch import Drawn, Mismatch
from benchbench.flight.reference import Reference
from benchbench.flight.rig import Rig
from benchbench.ground.arrays import Array

FRAME = table_one().airframe
RIG = Rig(motor_force=(0, 8), servo_torque=(-2, 2), ball_mass=0.075, pull=2.5)


def same(**ranges: object) -> Drawn:
    """No mismatch but what is named; inertias as the paper prints them."""
    return Mismatch(rigid=False, **ranges).draw(0)


def still(state: Array, target: Array, seconds: float = 1.0) -> Reference:
    """Stay in a state (15,) above a target at rest (3,)."""
    n = round(seconds / 0.002) + 1
    time = 0.002 * np.arange(n)
    hover = np.append(np.full(4, FRAME.total_mass * FRAME.gravity / 4), 0.0)
    return Reference(
        step=0.002, time=time, state=np.tile(state, (n, 1)), inputs=np.tile(hover, (n, 1)), acceleration=np.zeros((n, 3)),
        target=np.tile(np.append(target, np.zeros(3)), (n, 1)), ball_radius=0.03, reach=0.022, window=(0.5 * seconds, seconds), travel_time=seconds,
    )  # fmt: skip
