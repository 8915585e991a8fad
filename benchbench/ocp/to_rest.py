"""Scenarios that lead from one configuration to rest in another."""

from __future__ import annotations

from abc import ABC

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Ends, Scenario, at_rest, point, straight


class ToRest(Scenario, ABC):
    """From `start` to rest at `end`; what happens on the way says the kind."""

    def start_point(self, model: Model) -> Array:
        """Return the start configuration (n_q,)."""
        return point(self.start, model, "scenario.start")

    def end_point(self, model: Model) -> Array:
        """Return the end configuration (n_q,)."""
        return point(self.end, model, "scenario.end")

    def ends(self, model: Model) -> Ends:
        """Bounds of the last node: the end point, at rest."""
        return at_rest(self.end_point(model), self.limits(model), model)

    def flown(self, model: Model, nodes: int) -> Array:
        """Metres along the straight line from start to end, (nodes,)."""
        return straight(self.start_point(model), self.end_point(model), model, nodes)
