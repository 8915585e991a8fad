"""Motors that lag and have limits, and a servo with a loop of its own."""

from __future__ import annotations

import math
from typing import final

import numpy as np

from benchbench.flight.mismatch import Drawn
from benchbench.flight.rig import Rig
from benchbench.flight.world import STEP
from benchbench.ground.arrays import Array


@final
class Devices:
    """Of one flight, from the motor forces (4,) N of its beginning on; servo: stiffness N m/rad and damping N m s/rad."""

    def __init__(self, rig: Rig, mismatch: Drawn, motors: Array, servo: tuple[float, float]) -> None:
        """Motors turn as they are told at first."""
        self.rig, self.servo, self.bias = rig, servo, mismatch.servo_bias
        self.turning = motors.copy()
        self.gain = (1 + mismatch.thrust) * (1 + mismatch.motor) * [1 + mismatch.first_motor, 1.0, 1.0, 1.0]
        self.quickness = 1 - math.exp(-STEP / mismatch.motor_lag) if mismatch.motor_lag > 0 else 1.0

    def motors(self, asked: Array) -> Array:
        """Forces (4,) N a step later."""
        self.turning += self.quickness * (np.clip(asked, *self.rig.motor_force) - self.turning)
        return np.asarray(self.turning * self.gain)

    def torque(self, asked: tuple[float, float, float], angle: float, rate: float) -> float:
        """Torque N m about the joint, which stands at an angle rad and turns; its sensor tells too little by the bias."""
        (wanted, turning, forward), (stiffness, damping) = asked, self.servo
        total = forward + stiffness * (wanted - angle + self.bias) + damping * (turning - rate)
        low, high = self.rig.servo_torque
        return min(max(total, low), high)
