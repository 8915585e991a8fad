"""No residual model: the controller believes its own model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

from benchbench.flight.residual import Learned, Recorder, Residual, Sample


@final
class NoResidual(Residual):
    """Corrects nothing."""

    def learn(self, flights: Sequence[Sequence[Sample]]) -> Learned:
        """Learn nothing."""
        return Recorder
