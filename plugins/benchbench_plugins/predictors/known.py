"""The target moves as the scenario says: nothing is predicted, the certified plan is flown."""

from __future__ import annotations

from typing import final

from benchbench.flight.predictor import Predictor, Seen
from benchbench.ocp.motion import Motion


@final
class Known(Predictor):
    """Looks at nothing."""

    def predict(self, seen: Seen) -> Motion | None:
        """Nothing is new."""
        return None
