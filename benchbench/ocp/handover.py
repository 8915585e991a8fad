"""The handover: touch a moving target on the way, or several of them (paper Sec. IV.B)."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, ClassVar, Self, final

from pydantic import BaseModel, ConfigDict, Field, InstanceOf, model_validator

from benchbench.ground.errors import BadInput
from benchbench.ocp.contact import Contact, Contacts
from benchbench.ocp.motion import Motion
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.sizes import Nodes
from benchbench.ocp.stop import Itinerary, Stop
from benchbench.ocp.to_rest import ToRest
from benchbench.ocp.values import HandoverValues, NonNegative, Positive


class StopFields(BaseModel):
    """What a handover says about one of several stops; what it leaves out is as in the handover itself.

    target           motion of the target
    contacts         conditions that must hold together while in contact, by name
    kappa_init       number of consecutive nodes in contact
    contact_seconds  duration of the contact in s
    reward           seconds of travel time that making the stop is worth; only with visit: optional
    """

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    target: InstanceOf[Motion]
    contacts: dict[str, InstanceOf[Contact]] | None = None
    kappa_init: Nodes | None = None
    contact_seconds: NonNegative | None = None
    reward: Positive | None = None


@final
class Handover(HandoverValues, ToRest):
    """Fly from `start` to rest at `end` in least time and touch the moving target on the way, or several of them.

    What it has that is a plain value stands in `HandoverValues`; besides, it has

    target    motion of the target, where there is one
    stops     where there are several: stops by name, each with its target
    contacts  conditions that must hold together while in contact, by name
    """

    planning: ClassVar[tuple[str, ...]] = (*Scenario.planning, "contact_guess", "contact_margin", "aim")

    target: InstanceOf[Motion] | None = None
    stops: dict[str, StopFields] = Field(default_factory=dict)
    contacts: dict[str, InstanceOf[Contact]]

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
    def grid_intervals(self) -> int:
        """N."""
        return self.intervals

    def on_grid(self, intervals: int) -> Self:
        """Return the same with so many intervals; contacts last as long as before, in shares of the flight."""
        return self.model_copy(update={"intervals": intervals, "kappa_grid": self._counting})

    @property
    def _counting(self) -> int:
        """The grid whose nodes are counted."""
        return self.kappa_grid or self.intervals

    def _stop(self, name: str, target: Motion, contacts: Contacts, kappa: int, seconds: float | None) -> Stop:
        """A stop with its nodes on this grid: never fewer than two where two are asked for, never a shorter contact."""
        steps = max(-(-(kappa - 1) * self.intervals // self._counting), min(kappa - 1, 1))
        return Stop(name, target, contacts, steps + 1, seconds, counted=(kappa - 1, self._counting))

    @property
    def itinerary(self) -> Itinerary:
        """All stops; a handover with one `target` has one stop of that name."""
        if self.target is not None:
            only = self._stop("target", self.target, self.contacts, self.kappa_init, self.contact_seconds)
            return Itinerary((only,), middle=self.contact_guess, margins=self._unused)
        stops = (
            replace(
                self._stop(
                    name, given.target, self.contacts if given.contacts is None else given.contacts,
                    given.kappa_init or self.kappa_init,
                    self.contact_seconds if given.contact_seconds is None else given.contact_seconds,
                ),
                reward=given.reward, prefix=f"{name}_",
            )
            for name, given in self.stops.items()
        )  # fmt: skip
        return Itinerary(tuple(stops), self.order, self.visit, self.contact_guess, self._unused)

    @property
    def _unused(self) -> dict[str, float]:
        """Share of the limits of contacts that the planner leaves unused: all beyond its aim, and margins within it."""
        own = self.contact_margin
        return {**own, **{name: 1 - (1 - own.get(name, 0.0)) * aim for name, aim in self.aim.items()}}


def check_stops(scenario: Handover) -> None:
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
