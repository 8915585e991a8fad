"""Where the vehicle is now: what was sensed, moved on by the commands since then; and which accelerations surprised."""

from __future__ import annotations

import math
from collections import deque
from typing import final

import numpy as np

from benchbench.arrays import Array
from benchbench.flight.controller import Known
from benchbench.flight.payload import Weighing
from benchbench.flight.residual import Correction, Sample
from benchbench.flight.sensed import Command, Sensed
from benchbench_plugins.controllers.tables import Tables

LONGEST = 0.05
"""s of one step of moving on."""
KEPT = 60
"""Commands that are remembered, more than a second."""


@final
class Estimate:
    """Of one flight."""

    def __init__(self, table: Tables, known: Known, correction: Correction, weighing: Weighing) -> None:
        """Remember nothing yet."""
        self.table, self.correction, self.weighing = table, correction, weighing
        self.mass, self.gravity, self.grid = (
            known.airframe.total_mass,
            known.airframe.gravity,
            known.reference.step,
        )
        self.last: Sensed | None = None
        self.commands: deque[tuple[Command, float]] = deque(maxlen=KEPT)
        self.payload, self.constant = 0.0, np.zeros(3)

    def told(self, command: Command, payload: float) -> None:
        """Remember a command and the mass kg it was meant for."""
        self.commands.append((command, self.mass + payload))

    def now(self, sensed: Sensed, now: float) -> tuple[Array, float]:
        """Return position, quaternion and velocity (10,) now, and the payload kg."""
        if sensed is not self.last:
            self._learn(sensed)
            self.last = sensed
        p, q, v = sensed.state[:3].copy(), sensed.state[3:7], sensed.state[8:11].copy()
        omega, time = sensed.state[11:14], sensed.time
        while now - time > 1e-9 and self.commands:
            h = min(LONGEST, now - time)
            command, mass = self._given(time + h / 2)
            at = time + h / 2 - command.time
            asked = np.array(command.rates) + at * np.array(command.spin)
            omega = (omega + asked) / 2
            middle = turned(q, omega * (h / 2))
            a = self._model(middle, command.thrust / mass, time + h / 2) + self.constant
            p, v, q, time, omega = p + h * v + h * h / 2 * a, v + h * a, turned(q, omega * h), time + h, asked
        return np.concatenate([p, q, v]), self.payload

    def _learn(self, sensed: Sensed) -> None:
        """Compare the change of velocity with what the model gives for the commands in between."""
        last, command = self.last, None
        along = 0.0
        if last is not None and self.commands and sensed.time > last.time:
            h, middle = sensed.time - last.time, (sensed.time + last.time) / 2
            command, mass = self._given(middle)
            q = last.state[3:7] + sensed.state[3:7]
            q = q / np.linalg.norm(q)
            expected = self._model(q, command.thrust / mass, middle)
            surprise = (sensed.state[8:11] - last.state[8:11]) / h - expected
            self.correction.observe(Sample(sensed.time, sensed.state, surprise))
            along = float(_up(q) @ (surprise - self.constant))
            node = np.concatenate([sensed.state[:7], sensed.state[8:11]])[None]
            self.constant = self.correction.predict(node, sensed.state[7:8])[0][0]
        self.payload = self.weighing(sensed, command, along)

    def _given(self, time: float) -> tuple[Command, float]:
        """The command in force at a time."""
        for command, mass in reversed(self.commands):
            if command.time <= time:
                return command, mass
        return self.commands[0]

    def _model(self, q: Array, push: float, time: float) -> Array:
        """Acceleration of the model, with the arm's as in the reference."""
        row = min(max(round((time - self.table.start) / self.grid), 0), len(self.table.coupling) - 1)
        a = _up(q) * push + self.table.coupling[row]
        a[2] -= self.gravity
        return np.asarray(a)


def _up(q: Array) -> Array:
    w, x, y, z = q.tolist()
    return np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])


def turned(q: Array, by: Array) -> Array:
    """Return a quaternion (4,) turned by a rotation vector (3,) rad in its body frame."""
    w, x, y, z = q.tolist()
    a, b, c = by.tolist()
    angle = math.sqrt(a * a + b * b + c * c)
    s, co = (math.sin(angle / 2) / angle if angle > 1e-9 else 0.5), math.cos(angle / 2)
    a, b, c = a * s, b * s, c * s
    return np.array([
        w * co - x * a - y * b - z * c, x * co + w * a + y * c - z * b,
        y * co + w * b + z * a - x * c, z * co + w * c + x * b - y * a,
    ])  # fmt: skip
