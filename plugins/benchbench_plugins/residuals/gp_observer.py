"""Gaussian processes, and an observer of what they leave."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

from pydantic import validate_call

from benchbench.flight.extra import need
from benchbench.flight.residual import Learned, Residual, Sample, Training
from benchbench_plugins.residuals.filtered import Filtered, Gain
from benchbench_plugins.residuals.gp_fit import Points, enough, fit
from benchbench_plugins.residuals.gp_mean import GpCorrection


@final
class GpObserver(Residual):
    """The processes of `gp`, and what is not expected even so, low-pass filtered as by `observer`."""

    @validate_call
    def __init__(self, points: Points = 50, gain: Gain = 0.1, training: Training = 12.0) -> None:
        """As for `gp` and `observer`. Raises Unavailable without scikit-learn, BadInput for more points than samples."""
        need("sklearn", "residual=gp_observer")
        self.points, self.gain, self.training = enough(points, training), gain, training

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        """Fit; raises BadInput without samples."""
        mean = fit(flights, self.points)
        return lambda: GpCorrection(mean, Filtered(self.gain))
