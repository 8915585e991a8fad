"""The transfer: move to rest somewhere else."""

from __future__ import annotations

from typing import Self, final

from benchbench.ocp.stop import Itinerary
from benchbench.ocp.to_rest import ToRest
from benchbench.ocp.values import TransferValues


@final
class Transfer(TransferValues, ToRest):
    """Move from `start` to rest at `end` in least time; nothing is asked on the way. Its configuration says `kind: transfer`."""

    @property
    def grid_intervals(self) -> int:
        """N."""
        return self.intervals

    def on_grid(self, intervals: int) -> Self:
        """Return the same with so many intervals."""
        return self.model_copy(update={"intervals": intervals})

    @property
    def itinerary(self) -> Itinerary:
        """Nothing is touched."""
        return Itinerary()
