"""A scenario: the task, told without any solver, transcription or relaxation."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any, Self

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, InstanceOf, model_validator

from benchbench.arrays import Array
from benchbench.errors import BadInput
from benchbench.ocp.contact import Contact
from benchbench.ocp.model import Coordinates, Model, output_bounds, output_box, space, velocity_bounds
from benchbench.ocp.motion import Motion
from benchbench.ocp.stop import Itinerary, Order, Stop, Visit

NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


def _increasing(pair: tuple[float, float]) -> tuple[float, float]:
    if not pair[0] <= pair[1]:
        raise ValueError("the first number must not exceed the second")
    return pair


Range = Annotated[tuple[float, float], AfterValidator(_increasing)]


@dataclass(frozen=True)
class Ends:
    """Bounds of the last node: configuration (n_q,) and velocity (n_v,)."""

    lower_q: Array
    upper_q: Array
    lower_v: Array
    upper_v: Array


class StopFields(BaseModel):
    """What a scenario says about one of several stops; what it leaves out is as in the scenario itself.

    target           motion of the target
    contacts         conditions that must hold together while in contact, by name
    kappa_init       number of consecutive nodes in contact
    contact_seconds  duration of the contact in s
    reward           seconds of travel time that making the stop is worth; only with visit: optional
    """

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    target: InstanceOf[Motion]
    contacts: dict[str, InstanceOf[Contact]] | None = None
    kappa_init: Annotated[int, Field(ge=1)] | None = None
    contact_seconds: NonNegative | None = None
    reward: Positive | None = None


class Scenario(BaseModel):
    """Fly from `start` to `end` in least time and touch the moving target on the way, or several of them.

    start, end         coordinates by name (m, rad); what is not named is 0
    start_velocity     velocities at the start by coordinate name (m/s, rad/s); what is not named is 0; the end is at rest
    target             motion of the target, where there is one
    stops              where there are several: stops by name, each with its target
    order              fixed: stops are made as they are listed; free: in any order
    visit              all: every stop is made; one: exactly one; optional: those with a reward may be left out
    contacts           conditions that must hold together while in contact, by name
    kappa_init         number of consecutive nodes in contact, at least 1 (paper Eq. 26)
    contact_seconds    duration of the contact in s; null: (kappa_init - 1) average steps. Planned by the phase
                       formulations, asked for by the certificate; progress variables only count nodes
    contact_guess      where in the flight the contact is first guessed, as a fraction of the travel time;
                       several stops are spread evenly before and after this middle
    intervals          N, number of intervals of the time grid
    travel_time        allowed travel time [s, s]
    travel_time_guess  first guess of the travel time in s
    input_cost         c_u of the paper's cost t_N + c_u sum h |u - u_ref|^2, in 1/unit^2
    workspace          limits of coordinates by name that belong to the room, not to the vehicle
    rate_margin        share of a velocity limit that the planner leaves unused, by coordinate name: a
                       transcription keeps limits at its nodes, and the plan is judged by what is flown
    contact_margin     the same for the limits of contacts, by contact name
    hover_ends         first and last input equal hover (authors' public demo; not in the paper)
    """

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    name: str
    start: dict[str, Finite]
    end: dict[str, Finite]
    start_velocity: dict[str, Finite] = Field(default_factory=dict)
    target: InstanceOf[Motion] | None = None
    stops: dict[str, StopFields] = Field(default_factory=dict)
    order: Order = "fixed"
    visit: Visit = "all"
    contacts: dict[str, InstanceOf[Contact]]
    kappa_init: Annotated[int, Field(ge=1)] = 2
    contact_seconds: NonNegative | None = None
    contact_guess: Annotated[float, Field(gt=0, lt=1)] = 0.42
    intervals: Annotated[int, Field(ge=4)] = 100
    travel_time: Range = (0.1, 30.0)
    travel_time_guess: Positive = 3.0
    input_cost: NonNegative = 3e-3
    workspace: dict[str, Range] = Field(default_factory=dict)
    rate_margin: dict[str, Annotated[float, Field(ge=0, lt=1)]] = Field(default_factory=dict)
    contact_margin: dict[str, Annotated[float, Field(ge=0, lt=1)]] = Field(default_factory=dict)
    hover_ends: bool = False

    @model_validator(mode="before")
    @classmethod
    def _drop_disabled_contacts(cls, data: dict[str, Any]) -> dict[str, Any]:
        kept = {k: v for k, v in (data.get("contacts") or {}).items() if v is not None}
        return {**data, "contacts": kept}

    @model_validator(mode="after")
    def _one_target_or_stops(self) -> Self:
        check_stops(self)
        return self

    @property
    def itinerary(self) -> Itinerary:
        """All stops; a scenario with one `target` has one stop of that name."""
        if self.target is not None:
            only = Stop("target", self.target, self.contacts, self.kappa_init, self.contact_seconds)
            return Itinerary((only,))
        stops = (
            Stop(
                name, given.target, self.contacts if given.contacts is None else given.contacts,
                given.kappa_init or self.kappa_init,
                self.contact_seconds if given.contact_seconds is None else given.contact_seconds,
                given.reward, f"{name}_",
            )
            for name, given in self.stops.items()
        )  # fmt: skip
        return Itinerary(tuple(stops), self.order, self.visit)

    def start_point(self, model: Model) -> Array:
        """Return the start configuration (n_q,)."""
        return point(self.start, model, "scenario.start")

    def start_rates(self, model: Model) -> Array:
        """Return the velocity at the start (n_v,)."""
        v = np.zeros(len(model.velocity.names))
        for name, value in self.start_velocity.items():
            v[coordinate(name, model.velocity, "scenario.start_velocity")] = value
        return v

    def end_point(self, model: Model) -> Array:
        """Return the end configuration (n_q,)."""
        return point(self.end, model, "scenario.end")

    def ends(self, model: Model) -> Ends:
        """Bounds of the last node: the end point, at rest."""
        end, rest, box = self.end_point(model), np.zeros(len(model.velocity.names)), self.limits(model)
        low, high = (np.where(space(model).fixed_at_rest(), end, bound) for bound in (box.lower, box.upper))
        return Ends(low, high, rest, rest)

    def flown(self, model: Model, nodes: int) -> Array:
        """Nominal metres flown at each of `nodes` nodes, (nodes,): shares of the nominal path."""
        return np.linspace(0.0, self.path_length(model), nodes)

    def path_length(self, model: Model) -> float:
        """Length in m of the nominal path: the straight line."""
        metres = [i for i, unit in enumerate(model.configuration.units) if unit == "m"]
        return float(np.linalg.norm((self.end_point(model) - self.start_point(model))[metres]))

    def limits(self, model: Model) -> Coordinates:
        """Limits of the configuration: the vehicle's, tightened by the workspace."""
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


def check_stops(scenario: Scenario) -> None:
    """Raise BadInput where targets, stops, order and visit do not fit together."""
    stops = scenario.stops
    if scenario.target is not None and stops:
        allowed = "no target; each of scenario.stops has its own"
        raise BadInput("scenario.target", "is given beside scenario.stops", allowed)
    if scenario.target is None and not stops:
        raise BadInput("scenario.target", "is missing")
    if scenario.visit == "one" and len(stops) < 2:
        raise BadInput("scenario.visit", "one of several is asked for, but there is one stop", "all")
    for name, stop in stops.items():
        if not re.fullmatch(r"[A-Za-z](_?[A-Za-z0-9])*", name):
            raise BadInput(f"scenario.stops.{name}", "is no name", "letters, digits and single _ in between")
        if stop.reward is not None and scenario.visit != "optional":
            allowed = "no reward, or scenario.visit=optional"
            raise BadInput(
                f"scenario.stops.{name}.reward", f"means nothing with visit={scenario.visit}", allowed
            )
    if scenario.visit == "optional" and all(stop.reward is None for stop in stops.values()):
        allowed = "scenario.stops.NAME.reward, in s, for each stop that may be left out"
        raise BadInput("scenario.visit", "no stop has a reward, so none may be left out", allowed)


def coordinate(name: str, of: Coordinates, field: str) -> int:
    """Position of a coordinate by name; raises BadInput that lists the names when there is none."""
    if name not in of.names:
        raise BadInput(f"{field}.{name}", "the vehicle has no such coordinate", ", ".join(of.names))
    return of.index(name)


def point(values: dict[str, float], model: Model, field: str) -> Array:
    """Return a configuration (n_q,) from values by name; the rest is as in `Space.origin`."""
    q = np.asarray(space(model).origin(), float)
    for name, value in values.items():
        q[coordinate(name, model.configuration, field)] = value
    return q
