"""The target goes on straight ahead, as fast as it was seen to."""

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
from benchbench_plugins.predictors.windows import direction, latest


@final
@dataclass(frozen=True)
class Straight(Motion):
    """p(t) = place + t way, m and m/s."""

    place: Array
    way: Array

    @property
    def parameters(self) -> Array:
        """Place, then way."""
        return np.append(self.place, self.way)

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Straight line."""
        return parameters[:3] + time * parameters[3:]


@final
class ConstantVelocity(Predictor):
    """A line through the positions of the last `window` s by least squares; level, it points where the target pointed last.

    pointing  s, over which that is the mean
    slow      m/s, below which a target is said to stand: noise of positions is no direction to turn to
    """

    @validate_call
    def __init__(self, window: Positive = 1.0, pointing: Positive = 0.2, slow: NonNegative = 0.02) -> None:
        """Keep the numbers."""
        self.window, self.pointing, self.slow = window, pointing, slow

    def predict(self, seen: Seen) -> Motion:
        """Fit it."""
        recent = latest(seen, self.window)
        rows = np.stack([np.ones(len(recent.time)), recent.time], axis=-1)
        place, way = np.linalg.lstsq(rows, recent.position, rcond=None)[0]
        speed = float(np.hypot(*way[:2]))
        if speed < self.slow:
            way = np.array([0.0, 0.0, way[2]])
        elif (ahead := direction(latest(seen, self.pointing).heading)) is not None:
            way = np.array([speed * np.cos(ahead), speed * np.sin(ahead), way[2]])
        return Straight(place, way)
