"""A residual acceleration that is the same everywhere and follows what is observed."""

from __future__ import annotations

from typing import Annotated, final

import numpy as np
from pydantic import Field

from benchbench.flight.residual import Correction, Sample
from benchbench.ground.arrays import Array

Gain = Annotated[float, Field(gt=0, le=1)]
"""Share of each surprise that is believed."""


@final
class Filtered(Correction):
    """Begins with `value` (3,) m/s^2, world; gain 0 keeps it."""

    def __init__(self, gain: float, value: Array | None = None) -> None:
        self.gain, self.value = gain, np.zeros(3) if value is None else value.copy()

    def observe(self, sample: Sample) -> None:
        """Move towards it."""
        self.value += self.gain * (sample.acceleration - self.value)

    def predict(self, nodes: Array, arm: Array) -> tuple[Array, Array | None]:
        """The same at all nodes."""
        return np.tile(self.value, (len(nodes), 1)), None
