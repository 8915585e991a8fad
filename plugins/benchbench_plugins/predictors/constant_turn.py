"""The target goes on turning, level, at the rate and speed that were seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import casadi as ca
import numpy as np
from pydantic import validate_call

from benchbench.flight.predictor import Predictor, Seen
from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion
from benchbench.ocp.scenario import NonNegative, Positive
from benchbench_plugins.predictors.windows import latest

TINY = 1e-5
"""rad, half a turn below which the arc is a line: sin(y) / y is 1 to rounding."""


@final
@dataclass(frozen=True)
class Turning(Motion):
    """p(t) = place + speed * integral of (cos, sin)(heading + rate t), level; m, m/s, rad, rad/s."""

    place: Array
    speed: float
    heading: float
    rate: float

    @property
    def parameters(self) -> Array:
        """Place, speed, heading, rate."""
        return np.array([*self.place, self.speed, self.heading, self.rate])

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """An arc: its chord is speed * t * sin(y) / y at heading + y, y = rate t / 2."""
        half = parameters[5] * time / 2
        safe = ca.sqrt(half**2 + TINY**2)
        chord = parameters[3] * time * ca.sin(safe) / safe
        ahead = parameters[4] + half
        return parameters[:3] + chord * ca.vertcat(ca.cos(ahead), ca.sin(ahead), 0)


@final
class ConstantTurn(Predictor):
    """Rate from the headings of the last `window` s, then place and speed from the positions; two linear least squares.

    slow  m/s, below which a target is said to stand
    """

    @validate_call
    def __init__(self, window: Positive = 1.5, slow: NonNegative = 0.02) -> None:
        """Keep the numbers."""
        self.window, self.slow = window, slow

    def predict(self, seen: Seen) -> Motion:
        """Fit it."""
        recent = latest(seen, self.window)
        told = np.isfinite(recent.heading)
        if not told.any():
            return Turning(recent.position.mean(axis=0), 0.0, 0.0, 0.0)
        rate, heading = np.polyfit(recent.time[told], np.unwrap(recent.heading[told]), 1)
        arc = Turning(np.zeros(3), 1.0, float(heading), float(rate))
        ways = _along(arc, recent.time)
        middle, centre = ways.mean(axis=0), recent.position.mean(axis=0)
        speed = float(np.sum((ways - middle) * (recent.position - centre)) / np.sum((ways - middle) ** 2))
        if speed < self.slow:
            speed = 0.0
        return Turning(centre - speed * middle, speed, arc.heading, arc.rate)


def _along(arc: Turning, time: Array) -> Array:
    """Places (n, 3) on an arc."""
    half = arc.rate * time / 2
    chord = arc.speed * time * np.sinc(half / np.pi)
    return np.stack(
        [chord * np.cos(arc.heading + half), chord * np.sin(arc.heading + half), 0 * time], axis=-1
    )
