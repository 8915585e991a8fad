"""Gaussian processes of the residual acceleration, the paper's (Sec. V): mean and gradient inside the prediction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, final

from benchbench.flight.extra import need
from benchbench.flight.residual import Learned, Residual, Sample
from benchbench_plugins.residuals.filtered import Filtered
from benchbench_plugins.residuals.gp_fit import fit
from benchbench_plugins.residuals.gp_mean import GpCorrection


@final
class Gp(Residual):
    """One process per body axis i over the paper's features: height, arm angle, speed along the axis."""

    training: ClassVar[float] = 12.0

    def __init__(self, points: int = 50) -> None:
        """points: means of clusters of samples that are kept. Raises Unavailable without scikit-learn."""
        need("sklearn", "residual=gp")
        self.points = points

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        """Fit; raises BadInput without samples."""
        mean = fit(flights, self.points)
        return lambda: GpCorrection(mean, Filtered(0.0))
