"""Sensors: the truth of some time ago, with noise, and sometimes nothing new for a while."""

from __future__ import annotations

from typing import final

import numpy as np

from benchbench.flight.mismatch import Drawn
from benchbench.flight.sensed import Sensed, Triple
from benchbench.flight.world import STEP, Truth


@final
class Sensors:
    """Of one flight, from the truth at its beginning on; the noise follows from the seed of the mismatch alone."""

    def __init__(self, mismatch: Drawn, contact: float, salt: int = 0) -> None:
        """Keep delay, noise and the time without news; salt: another noise of the same flight."""
        self.noise = np.random.default_rng([mismatch.seed, salt])
        self.old: list[Truth] = []
        self.late = round(mismatch.delay / STEP)
        self.blind = (contact - mismatch.blind_before, contact - mismatch.blind_before + mismatch.blind)
        m = mismatch
        spread = [m.position_noise] * 3 + [m.attitude_noise] * 3 + [m.arm_noise]
        self.spread = np.array(spread + [m.velocity_noise] * 3 + [m.rate_noise] * 3 + [0.0])
        self.rate_noise = m.rate_noise
        self.last: Sensed | None = None

    def hear(self, truth: Truth) -> None:
        """Take the truth of one step."""
        self.old.append(truth)
        if len(self.old) > self.late + 1:
            del self.old[0]

    def gyro(self) -> Triple:
        """Body rates rad/s now."""
        w = self.old[-1].state[11:14].tolist()
        if self.rate_noise > 0:
            w = (np.array(w) + self.noise.normal(0.0, self.rate_noise, 3)).tolist()
        return w[0], w[1], w[2]

    def sensed(self) -> Sensed:
        """Return what a controller is told now."""
        truth = self.old[0]
        if self.last is not None and self.blind[0] <= truth.time < self.blind[1]:
            return self.last
        self.last = Sensed(truth.time, self._noisy(truth), truth.attached)
        return self.last

    def _noisy(self, truth: Truth) -> np.ndarray:
        if not self.spread.any():
            return truth.state
        d = self.noise.normal(0.0, 1.0, 14) * self.spread
        state = truth.state.copy()
        state[:3] += d[:3]
        w, x, y, z = state[3:7].tolist()
        a, b, c = (d[3:6] / 2).tolist()
        turned = (
            w - x * a - y * b - z * c,
            x + w * a + y * c - z * b,
            y + w * b + z * a - x * c,
            z + w * c + x * b - y * a,
        )
        state[3:7] = np.array(turned) / np.linalg.norm(turned)
        state[7:] += d[6:]
        return state
