"""The task."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self, final

import numpy as np
from pydantic import Field

from benchbench import Array, Model, Scenario
from benchbench.ocp.scenario import Ends, Positive, at_rest, point, straight
from benchbench.ocp.stop import Itinerary

AXES = ("x", "y", "z")


@final
class Reach(Scenario):
    """Fly from `start` in least time to rest anywhere within `reach` m of `end`, upright; nothing is touched.

    reach      radius of the ball around the end, m; a scenario with this field is of this kind
    intervals  N, number of intervals of the time grid
    """

    mark: ClassVar[tuple[str, ...]] = ("reach",)

    reach: Positive
    intervals: Annotated[int, Field(ge=4)] = 100

    @property
    def grid_intervals(self) -> int:
        """N."""
        return self.intervals

    def on_grid(self, intervals: int) -> Self:
        """Return the same with so many intervals."""
        return self.model_copy(update={"intervals": intervals})

    @property
    def itinerary(self) -> Itinerary:
        """Nothing."""
        return Itinerary()

    def start_point(self, model: Model) -> Array:
        """Return the start configuration (n_q,)."""
        return point(self.start, model, "scenario.start")

    def end_point(self, model: Model) -> Array:
        """Return the configuration (n_q,) in the middle of the ball."""
        return point(self.end, model, "scenario.end")

    def ends(self, model: Model) -> Ends:
        """Bounds of the last node: at rest, but wherever the room allows; the ball is a row of the problem."""
        box = self.limits(model)
        still = at_rest(self.end_point(model), box, model)
        place = np.isin(model.configuration.names, AXES)
        low, high = np.where(place, box.lower, still.lower_q), np.where(place, box.upper, still.upper_q)
        return Ends(low, high, still.lower_v, still.upper_v)

    def flown(self, model: Model, nodes: int) -> Array:
        """Metres along the straight line to the middle, (nodes,)."""
        return straight(self.start_point(model), self.end_point(model), model, nodes)


def off(scenario: Reach, model: Model, configuration: Array) -> Array:
    """Return the distances in m, (n,), of configurations (n, n_q) from the middle of the ball."""
    place = [model.configuration.index(axis) for axis in AXES]
    return np.asarray(np.linalg.norm(configuration[:, place] - scenario.end_point(model)[place], axis=1))
