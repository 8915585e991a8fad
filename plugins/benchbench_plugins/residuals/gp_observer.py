"""Gaussian processes, and an observer of what they leave."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, final

from benchbench.flight.extra import need
from benchbench.flight.residual import Learned, Residual, Sample
from benchbench_plugins.residuals.filtered import Filtered
from benchbench_plugins.residuals.gp_fit import fit
from benchbench_plugins.residuals.gp_mean import GpCorrection


@final
class GpObserver(Residual):
    """The processes of `gp`, and what is not expected even so, low-pass filtered as by `observer`."""

    training: ClassVar[float] = 12.0

    def __init__(self, points: int = 50, gain: float = 0.1) -> None:
        """As for `gp` and `observer`. Raises Unavailable without scikit-learn."""
        need("sklearn", "residual=gp_observer")
        self.points, self.gain = points, gain

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        """Fit; raises BadInput without samples."""
        mean = fit(flights, self.points)
        return lambda: GpCorrection(mean, Filtered(self.gain))
