"""What is seen of a target in one flight: its true motion, a little late and with noise."""

from __future__ import annotations

from typing import final

import numpy as np

from benchbench.flight.mismatch import Drawn
from benchbench.flight.predictor import Seen
from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion, sample

EYE = 0.02
"""s from one observation to the next: motion capture, or a camera, at 50 Hz."""
SALT = 2
"""Noise of observations is not that of the vehicle's own state."""
STILL = 1e-3
"""m/s, below which a target points where it pointed before."""


@final
class Sight:
    """All observations of one flight, made at its beginning; they follow from the seed of the mismatch alone."""

    def __init__(self, target: Motion, mismatch: Drawn, begin: float, end: float) -> None:
        """Observe a target, which is as late as the mismatch says, from `begin` to `end` s as the plan counts."""
        noise = np.random.default_rng([mismatch.seed, SALT])
        self.time: Array = begin + EYE * np.arange(round((end - begin) / EYE) + 1, dtype=float)
        position, velocity = sample(target, self.time - mismatch.target_late)
        count, self.delay = len(self.time), mismatch.delay
        self.position = position + noise.normal(0.0, 1.0, (count, 3)) * mismatch.target_noise
        self.heading = pointing(velocity) + noise.normal(0.0, 1.0, count) * mismatch.target_heading_noise

    def seen(self, now: float, begin: float) -> Seen:
        """Return what is known at a time, for a plan that begins at another; both as the plan counts."""
        known = self.time <= now - self.delay + 1e-9
        return Seen(self.time[known] - begin, self.position[known], self.heading[known])


def pointing(velocity: Array) -> Array:
    """Level direction (n,) rad of velocities (n, 3); that of before where they are still, NaN where none was."""
    moves = np.hypot(velocity[:, 0], velocity[:, 1]) > STILL
    last = np.maximum.accumulate(np.where(moves, np.arange(len(moves)), -1))
    direction = np.arctan2(velocity[:, 1], velocity[:, 0])[last]
    return np.asarray(np.where(last >= 0, direction, np.nan))
