"""A scenario: the task, told without any solver, transcription or relaxation; what every kind of it has."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from pydantic import Field, InstanceOf, field_validator

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.contact import Contact
from benchbench.ocp.cost import Cost
from benchbench.ocp.model import (
    Coordinates,
    Model,
    input_bounds,
    output_bounds,
    output_box,
    space,
    velocity_bounds,
)
from benchbench.ocp.stop import Itinerary
from benchbench.ocp.values import Finite, FlightValues, NonNegative, Positive, Range, Share

__all__ = [
    "Ends", "Finite", "NonNegative", "Positive", "Range", "Scenario", "Share", "at_rest", "coordinate", "point", "straight",
]  # fmt: skip
"""Types of numbers are from here, too: whoever writes a scenario or a part of one needs them."""


@dataclass(frozen=True)
class Ends:
    """Bounds of the last node: configuration (n_q,) and velocity (n_v,)."""

    lower_q: Array
    upper_q: Array
    lower_v: Array
    upper_v: Array


class Scenario(FlightValues, ABC):
    """Fly from `start` to `end` in least time; what happens on the way, and how the flight ends, says the kind.

    What it has that is a plain value stands in `FlightValues`; besides, it may have

    obstacles  contacts that are kept always, by name
    costs      terms of the cost beside the travel time and the inputs, by name

    A kind is a final subclass with fields of its own, perhaps a `mark`, and

    planning  names of fields that only say how a planner goes about it: no certificate asks for them, and travel times
              may be compared whatever they are
    """

    planning: ClassVar[tuple[str, ...]] = ("travel_time_guess", "rate_margin", "kept_margins", "authority")

    obstacles: dict[str, InstanceOf[Contact]] = Field(default_factory=dict)
    costs: dict[str, InstanceOf[Cost]] = Field(default_factory=dict)

    @field_validator("obstacles", "costs", mode="before")
    @classmethod
    def _drop_disabled(cls, given: Any) -> Any:
        return {k: v for k, v in given.items() if v is not None} if isinstance(given, dict) else given

    @field_validator("obstacles")
    @classmethod
    def _kept_always(cls, given: dict[str, Contact]) -> dict[str, Contact]:
        for name, one in given.items():
            if one.kept != "always":
                problem = f"a {type(one).__name__} is kept {one.kept}"
                raise BadInput(f"scenario.obstacles.{name}", problem, "a contact that is kept always")
        return given

    @property
    @abstractmethod
    def grid_intervals(self) -> int:
        """N, number of intervals of the time grid."""

    @abstractmethod
    def on_grid(self, intervals: int) -> Self | None:
        """Return the same with so many intervals, or about as many as its grid can have; None where it has only one grid.

        What the plan is asked for stays as it was on the grid before: a contact lasts as long.
        """

    @property
    @abstractmethod
    def itinerary(self) -> Itinerary:
        """What is touched on the way, perhaps nothing."""

    @abstractmethod
    def start_point(self, model: Model) -> Array:
        """Return the start configuration (n_q,); raises BadInput for a coordinate that the vehicle lacks."""

    @abstractmethod
    def end_point(self, model: Model) -> Array:
        """Return the end configuration (n_q,), where the end is one; raises BadInput as `start_point` does."""

    @abstractmethod
    def ends(self, model: Model) -> Ends:
        """Bounds of the last node."""

    @abstractmethod
    def flown(self, model: Model, nodes: int) -> Array:
        """Nominal metres flown at each of `nodes` nodes, (nodes,): shares of the nominal path."""

    def start_rates(self, model: Model) -> Array:
        """Return the velocity at the start (n_v,); raises BadInput for a coordinate that the vehicle lacks."""
        v = np.zeros(len(model.velocity.names))
        for name, value in self.start_velocity.items():
            v[coordinate(name, model.velocity, "scenario.start_velocity")] = value
        return v

    def limits(self, model: Model) -> Coordinates:
        """Limits of the configuration: the vehicle's, tightened by the workspace; raises BadInput where none are left."""
        own = model.configuration
        lower, upper = own.lower.copy(), own.upper.copy()
        for name, (low, high) in self.workspace.items():
            i = coordinate(name, own, "scenario.workspace")
            lower[i], upper[i] = max(lower[i], low), min(upper[i], high)
            if lower[i] > upper[i]:
                raise BadInput(
                    f"scenario.workspace.{name}",
                    f"[{low}, {high}] leaves nothing of the vehicle's own limits",
                )
        return Coordinates(own.names, own.units, lower, upper)

    def planned_rates(self, model: Model) -> Coordinates:
        """Velocity limits as the planner keeps them: the vehicle's, less `rate_margin`."""
        own, share = model.velocity, self._rate_shares(model)
        return Coordinates(own.names, own.units, own.lower * share, own.upper * share)

    def planned_rates_at(self, model: Model, flown: Array) -> tuple[Array, Array]:
        """Return the same where `flown` (n,) m of the nominal path lie behind: lower and upper, each (n, n_v)."""
        lower, upper = velocity_bounds(model, flown)
        share = self._rate_shares(model)
        return lower * share, upper * share

    def planned_inputs_at(self, model: Model, flown: Array) -> tuple[Array, Array]:
        """Return limits of the inputs as the planner keeps them, less `authority`, each (n, n_u)."""
        lower, upper = input_bounds(model, flown)
        left = self.authority / 2 * (upper - lower)
        return lower + left, upper - left

    def planned_outputs_at(self, model: Model, flown: Array) -> tuple[Array, Array]:
        """Return limits of the model's outputs in the same way, each (n, n_y)."""
        lower, upper = output_bounds(model, flown)
        share = self._shares(output_box(model), model.velocity)
        return lower * share, upper * share

    def _rate_shares(self, model: Model) -> Array:
        return self._shares(model.velocity, output_box(model))

    def _shares(self, of: Coordinates, other: Coordinates) -> Array:
        share = np.ones(len(of.names))
        for name, margin in self.rate_margin.items():
            if name not in other.names:
                share[coordinate(name, of, "scenario.rate_margin")] -= margin
        return share


def at_rest(end: Array, limits: Coordinates, model: Model) -> Ends:
    """Bounds of the last node of a flight that ends at rest in `end` (n_q,), in all that is not free at rest."""
    still, fixed = np.zeros(len(model.velocity.names)), space(model).fixed_at_rest()
    low, high = (np.where(fixed, end, bound) for bound in (limits.lower, limits.upper))
    return Ends(low, high, still, still)


def straight(start: Array, end: Array, model: Model, nodes: int) -> Array:
    """Metres flown at each of `nodes` nodes, (nodes,), along the straight line from start to end, each (n_q,)."""
    metres = [i for i, unit in enumerate(model.configuration.units) if unit == "m"]
    return np.linspace(0.0, float(np.linalg.norm((end - start)[metres])), nodes)


def coordinate(name: str, of: Coordinates, field: str) -> int:
    """Position of a coordinate by name; raises BadInput that lists the names when there is none."""
    if name not in of.names:
        raise BadInput(f"{field}.{name}", "the vehicle has no such coordinate", ", ".join(of.names))
    return of.index(name)


def point(values: dict[str, float], model: Model, field: str) -> Array:
    """Return a configuration (n_q,) from values by name; the rest is as in `Space.origin`. Raises BadInput."""
    q = np.asarray(space(model).origin(), float)
    for name, value in values.items():
        q[coordinate(name, model.configuration, field)] = value
    return q
