"""A rate loop as PX4's, and a mixer that gives up yaw first.

PX4 (docs.px4.io, "Multicopter PID Tuning"): torque = P (asked - rate) + integral of I (asked - rate) - D d rate/dt + forward, with
anti-windup where a motor is at its limit; "airmode" off. Roll and pitch come before thrust, thrust before yaw.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from benchbench.flight.controller import Known
from benchbench.flight.inertia import rigid
from benchbench.flight.sensed import Command, Triple
from benchbench.flight.statics import hover, mixer
from benchbench.flight.world import STEP
from benchbench.ground.arrays import Array

SMOOTH = 1 - math.exp(-2 * math.pi * 30.0 * STEP)
"""Share of a new derivative that is believed: a low-pass of 30 Hz, PX4's default for it."""


@dataclass(frozen=True)
class Gains:
    """proportional 1/s, integral 1/s^2 and derivative 1, times the inertia, about x, y and z."""

    proportional: tuple[float, ...]
    integral: tuple[float, ...]
    derivative: tuple[float, ...]


@final
class RateLoop:
    """Of one flight; forward: 1 adds the plan's torques, 0 leaves them to the integral."""

    def __init__(self, known: Known, gains: Gains, forward: float) -> None:
        """Preload the integral with what holds the arm in the first state."""
        frame = known.airframe
        self.inertia = _locked(known).tolist()
        self.p = [g * j for g, j in zip(gains.proportional, self.inertia, strict=True)]
        self.i = [g * j * STEP for g, j in zip(gains.integral, self.inertia, strict=True)]
        self.d = [g * j for g, j in zip(gains.derivative, self.inertia, strict=True)]
        self.before, self.turning = (0.0, 0.0, 0.0), [0.0, 0.0, 0.0]
        mix = mixer(frame)
        start = mix @ hover(frame, float(known.reference.state[0, 7]))[:4]
        self.sum = [float(t) * (1 - forward) for t in start[1:]]
        self.unmix, self.forward = np.linalg.inv(mix), forward
        self.low, self.high = known.rig.motor_force

    def motors(self, command: Command, now: float, gyro: Triple) -> Array:
        """Return motor forces (4,) N."""
        since = now - command.time
        torque, error = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        for k in range(3):
            error[k] = command.rates[k] + since * command.spin[k] - gyro[k]
            self.turning[k] += SMOOTH * ((gyro[k] - self.before[k]) / STEP - self.turning[k])
            torque[k] = (
                self.p[k] * error[k] + self.sum[k] - self.d[k] * (self.turning[k] - command.spin[k])
                + self.inertia[k] * command.spin[k] * (1 - self.forward) + self.forward * command.torque[k]
            )  # fmt: skip
        self.before = gyro
        forces, kept = self._mixed(command.thrust, torque)
        for k in range(3):
            if kept[k]:
                self.sum[k] += self.i[k] * error[k]
        return forces

    def _mixed(self, thrust: float, torque: list[float]) -> tuple[Array, tuple[bool, bool, bool]]:
        """Forces within the limits, and which torques they give."""
        forces = self.unmix @ [thrust, *torque]
        if forces.min() >= self.low and forces.max() <= self.high:
            return forces, (True, True, True)
        level = self.unmix[:, 1:3] @ torque[:2]
        spread = float(level.max() - level.min())
        whole = spread <= self.high - self.low
        level = level if whole else level * ((self.high - self.low) / spread)
        least, most = self.low - float(level.min()), self.high - float(level.max())
        level = level + min(max(thrust / 4, least), max(most, least))
        yaw = self.unmix[:, 3] * torque[2]
        room = np.where(yaw > 0, self.high - level, level - self.low) / np.maximum(np.abs(yaw), 1e-12)
        share = min(max(float(room.min()), 0.0), 1.0)
        return np.clip(level + share * yaw, self.low, self.high), (whole, whole, share >= 1.0)


def _locked(known: Known) -> Array:
    """Moments of inertia (3,) kg m^2 about the body axes with the arm straight down, locked."""
    frame = known.airframe
    x, y, z = rigid(frame.arm_inertia)
    down = (frame.arm_offset + frame.arm_length / 2) ** 2 * frame.arm_mass
    return rigid(frame.inertia) + np.array([z + down, y + down, x])
