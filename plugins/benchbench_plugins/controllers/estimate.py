"""Where the vehicle will be when a command works: what was sensed, moved on; and which accelerations surprised.

What the reference asks for is fed forward, its thrust a little early; that, and what a command changes about it, works `latency`
after it was told (motors, rate loop).
"""

from __future__ import annotations

import math
from collections import deque
from typing import final

import numpy as np

from benchbench.flight.controller import Known
from benchbench.flight.payload import Weighing
from benchbench.flight.residual import Correction, Sample
from benchbench.flight.sensed import Command, Sensed
from benchbench.ground.arrays import Array
from benchbench_plugins.controllers.tables import Tables

LONGEST = 0.03
"""s of one step of moving on."""
RARE = 0.05
"""s between two states beyond which their difference says little of what was commanded in between."""
BELIEVED = np.array([0.5] * 3 + [0.3] * 4 + [0.5] * 3)
"""Shares of what is sensed anew in position, attitude and velocity: the rest is noise, which a time without news would keep."""
PULLED = 10
"""Samples, a fifth of a second, before a ball is attached: what surprised since then may have been the magnet's pull."""
KEPT = 60
"""Commands that are remembered, more than a second."""
NOTHING = np.zeros(4)


@final
class Estimate:
    """Of one flight."""

    def __init__(
        self,
        table: Tables,
        known: Known,
        correction: Correction,
        weighing: Weighing,
        latency: float,
        lead: float,
    ) -> None:
        """Remember nothing yet; lead: s by which thrust of the reference is told early, so that it works latency - lead late."""
        self.late = latency - lead
        self.table, self.correction, self.weighing, self.latency = table, correction, weighing, latency
        self.reference, self.mass, self.gravity = (
            known.reference,
            known.airframe.total_mass,
            known.airframe.gravity,
        )
        self.last: Sensed | None = None
        self.state = np.zeros(10)
        self.given: deque[tuple[Command, Array]] = deque(maxlen=KEPT)
        self.payload, self.constant = 0.0, np.zeros(3)
        self.alone: deque[Array] = deque([self.constant], maxlen=PULLED)

    def remember(self, other: Estimate) -> None:
        """Go on where another one is, of the same flight."""
        self.last, self.given, self.state = other.last, other.given, other.state
        self.payload, self.constant, self.alone = other.payload, other.constant, other.alone

    def told(self, command: Command, change: Array) -> None:
        """Remember a command, and by which rates and thrust over mass (4,) it changes the reference's."""
        self.given.append((command, change))

    def ahead(self, sensed: Sensed, now: float) -> tuple[Array, float]:
        """Return position, quaternion and velocity (10,) a latency from now, and the payload in kg."""
        if sensed is not self.last:
            self._learn(sensed)
            self.state = self._filtered(sensed)
            self.last = sensed
        return self._moved(self.state, sensed.state[11:14], sensed.time, now + self.latency), self.payload

    def _filtered(self, sensed: Sensed) -> Array:
        """Position, quaternion and velocity (10,): what was sensed, and what the last estimate has become by then."""
        found, last = np.concatenate([sensed.state[:7], sensed.state[8:11]]), self.last
        if last is None or not 0 < sensed.time - last.time < RARE:
            return found
        omega = (last.state[11:14] + sensed.state[11:14]) / 2
        old = self._moved(self.state, omega, last.time, sensed.time, omega)
        old[3:7] *= math.copysign(1.0, float(old[3:7] @ found[3:7]))
        mixed = old + BELIEVED * (found - old)
        mixed[3:7] /= np.linalg.norm(mixed[3:7])
        return mixed

    def _moved(
        self, state: Array, omega: Array, time: float, until: float, turning: Array | None = None
    ) -> Array:
        """A state (10,) some time later, turning at what was commanded, or at what was sensed."""
        p, q, v = state[:3], state[3:7], state[7:]
        while until - time > 1e-9:
            h = min(LONGEST, until - time)
            middle = time + h / 2
            row, (_, change) = self.reference.row(middle), self._given(middle)
            asked = self.reference.state[row, 11:14] + change[:3] if turning is None else turning
            omega = (omega + asked) / 2
            a = self._model(turned(q, omega * (h / 2)), middle, change[3]) + self.constant
            p, v, q, time, omega = p + h * v + h * h / 2 * a, v + h * a, turned(q, omega * h), time + h, asked
        return np.concatenate([p, q, v])

    def _learn(self, sensed: Sensed) -> None:
        """Compare the change of velocity with what the model gives for the commands in between."""
        last, command, along = self.last, None, 0.0
        if last is not None and 0 < sensed.time - last.time < RARE:
            h, middle = sensed.time - last.time, (sensed.time + last.time) / 2
            command, change = self._given(middle)
            q = last.state[3:7] + sensed.state[3:7]
            q = q / np.linalg.norm(q)
            expected = self._model(q, middle, change[3])
            surprise = (sensed.state[8:11] - last.state[8:11]) / h - expected
            self.correction.observe(Sample(sensed.time, sensed.state, surprise))
            if not sensed.attached:
                self.alone.append(self.constant)
            along = float(_up(q) @ (surprise - self.alone[0]))
            node = np.concatenate([sensed.state[:7], sensed.state[8:11]])[None]
            self.constant = self.correction.predict(node, sensed.state[7:8])[0][0]
        self.payload = self.weighing(sensed, command, along)

    def _given(self, time: float) -> tuple[Command | None, Array]:
        """The command that works at a time."""
        for command, change in reversed(self.given):
            if command.time <= time - self.latency + 1e-9:
                return command, change
        return None, NOTHING

    def _model(self, q: Array, time: float, change: float) -> Array:
        """Acceleration of the model at a time, with the arm's as in the reference, whose thrust comes late."""
        row = self.reference.row(time)
        push = self.table.wrench[self.reference.row(time - self.late), 0] / self.mass + change
        share = self.payload / (self.mass + self.payload)
        a = _up(q) * push + self.table.coupling[row] + share * self.table.apart[row]
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
