"""Gaussian processes of the residual acceleration, the paper's (Sec. V): mean and gradient inside the prediction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

from pydantic import validate_call

from benchbench.flight.extra import need
from benchbench.flight.residual import Learned, Residual, Sample, Training
from benchbench_plugins.residuals.filtered import Filtered
from benchbench_plugins.residuals.gp_fit import Points, enough, fit
from benchbench_plugins.residuals.gp_mean import GpCorrection


@final
class Gp(Residual):
    """One process per body axis i over the paper's features: height, arm angle, speed along the axis."""

    @validate_call
    def __init__(self, points: Points = 50, training: Training = 12.0) -> None:
        """points: means of clusters of samples that are kept; training: s of the flight that is learned from.

        Raises Unavailable without scikit-learn, BadInput for more points than samples.
        """
        need("sklearn", "residual=gp")
        self.points, self.training = enough(points, training), training

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        """Fit; raises BadInput without samples."""
        mean = fit(flights, self.points)
        return lambda: GpCorrection(mean, Filtered(0.0))
