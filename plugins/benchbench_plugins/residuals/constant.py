"""A constant bias, learned from a flight before."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np
from pydantic import validate_call

from benchbench.flight.residual import Learned, Residual, Sample, Training
from benchbench.ground.errors import BadInput
from benchbench_plugins.residuals.filtered import Filtered


@final
class Constant(Residual):
    """The mean of the residual acceleration of a training flight, in the world; what a Gaussian process has to beat."""

    @validate_call
    def __init__(self, training: Training = 12.0) -> None:
        """training: s of the flight that is learned from."""
        self.training = training

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        """Take the mean."""
        samples = [sample.acceleration for flight in flights for sample in flight]
        if not samples:
            raise BadInput("residual", "'constant' has no training flight to learn from", "one at least")
        mean = np.mean(samples, axis=0)
        return lambda: Filtered(0.0, mean)
