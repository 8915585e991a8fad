"""How far a vehicle can be from where it rests, by what its model proves, else by its speed limits alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.model import AXES, AgileModel, Model, output_box, space
from benchbench.ocp.scenario import Scenario

TURNS = ("yaw", "qz")
"""Coordinates of which one says whether a place to rest at fixes the heading."""


@dataclass(frozen=True, eq=False)
class Leg:
    """The way from a state of the vehicle, or in reversed time the way to it.

    configuration (n_q,); rests: the vehicle stands still there; headed: its heading is fixed there
    """

    model: Model
    configuration: Array
    rests: bool
    headed: bool = True

    @property
    def place(self) -> Array:
        """Position (3,) m."""
        return self.configuration[_axes(self.model)]

    @property
    def heading(self) -> float | None:
        """Direction of the nose, rad; None where it is open."""
        nose = self.model.plant().nose(self.configuration)
        return float(np.arctan2(nose[1], nose[0])) if self.headed else None

    def way(self, time: Array) -> tuple[Array, Array]:
        """Return metres back and ahead along each axis, both (n, 3), that are not passed in `time` (n,) s."""
        index, late = _axes(self.model), np.maximum(time, 0.0)[:, None]
        back, ahead = -self.model.velocity.lower[index] * late, self.model.velocity.upper[index] * late
        if self.rests and isinstance(self.model, AgileModel):
            near = self.model.way_from_rest(self.configuration, time)
            back, ahead = np.minimum(back, near[0]), np.minimum(ahead, near[1])
        return back, ahead


def legs(scenario: Scenario, model: Model) -> tuple[Leg, Leg]:
    """The way from the start, and that to the end of a flight that ends at rest in `scenario.end`."""
    still, fixed = not np.any(scenario.start_rates(model)), space(model).fixed_at_rest()
    names = model.configuration.names
    headed = any(name in names and bool(fixed[names.index(name)]) for name in TURNS)
    return (
        Leg(model, scenario.start_point(model), still),
        Leg(model, scenario.end_point(model), True, headed),
    )


def yaw_rate(model: Model) -> float:
    """Largest rate of the nose's heading in rad/s; inf where the vehicle has no limit of that name."""
    for of, name in ((model.velocity, "yaw"), (output_box(model), "yaw_rate")):
        if name in of.names:
            i = of.index(name)
            return float(max(abs(of.lower[i]), abs(of.upper[i])))
    return float(np.inf)


def _axes(model: Model) -> list[int]:
    return [model.configuration.index(name) for name in AXES]
