"""A disturbance observer: the acceleration that was not expected, low-pass filtered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

from pydantic import validate_call

from benchbench.flight.residual import Learned, Residual, Sample
from benchbench_plugins.residuals.filtered import Filtered, Gain


@final
class Observer(Residual):
    """Adds a share `gain` of each surprise to what it expects, and expects it for the whole horizon."""

    @validate_call
    def __init__(self, gain: Gain = 0.1) -> None:
        """gain: of 50 surprises a second; 0.1 is a time constant of 0.2 s."""
        self.gain = gain

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        """Learn nothing before the flight."""
        return lambda: Filtered(self.gain)
