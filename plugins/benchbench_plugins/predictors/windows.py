"""What predictors share: the last of what was seen, and the mean of directions."""

from __future__ import annotations

import numpy as np

from benchbench.flight.predictor import Seen
from benchbench.ground.arrays import Array

FEWEST = 3
"""Observations that are used at least, however old."""


def latest(seen: Seen, seconds: float) -> Seen:
    """Return what was seen in the last seconds before the newest observation."""
    count = max(int(np.sum(seen.time >= seen.time[-1] - seconds - 1e-9)), FEWEST)
    return Seen(seen.time[-count:], seen.position[-count:], seen.heading[-count:])


def direction(heading: Array) -> float | None:
    """Return the mean direction in rad; None where there is none."""
    told = heading[np.isfinite(heading)]
    return float(np.arctan2(np.sin(told).mean(), np.cos(told).mean())) if len(told) else None
