"""Deliveries: things are picked up and put down at several stops on one flight."""

from __future__ import annotations

from typing import Annotated, Any, final

from pydantic import ConfigDict, Field
from pydantic.dataclasses import dataclass

from benchbench.ocp.scenario import Positive
from benchbench.ocp.task_family import AboveZero, AtLeastZero, Between, Chance, Draws, TaskFamily
from benchbench_plugins.task_families.targets import Targets
from benchbench_plugins.task_families.way import Way

NAMES = ("pick", "hand", "put")
Stops = Annotated[int, Field(ge=2, le=len(NAMES))]


@final
@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class Deliveries(TaskFamily):
    """Two or three stops, spread over the way from start to end.

    way                where start, end and targets are, see `Way`
    stops              how many, 2 or 3
    along              how far a stop is from where an even spread would have it, share of the way
    targets            how the targets move, see `Targets`
    contact_s          s a contact lasts
    step_s             s from one node in contact to the next, about: it gives kappa_init
    free               how often the order of the stops is open
    optional           how often the last but one stop may be left out
    reward_s           s of travel time that it is worth then
    intervals_per_leg  from one stop to the next: N is so many for each stop and the end
    """

    way: Way
    stops: tuple[Stops, Stops]
    along: Between
    targets: Targets
    contact_s: AtLeastZero
    step_s: Positive
    free: Chance
    optional: Chance
    reward_s: AboveZero
    intervals_per_leg: Annotated[int, Field(ge=4)]

    def draw(self, draws: Draws) -> dict[str, Any]:
        """Return start, end, stops, their order and whether all are made, and N."""
        count = draws.whole("stops", self.stops)
        names = NAMES if count == len(NAMES) else (NAMES[0], NAMES[-1])
        stops = {name: self._stop(draws, name, (i + 1) / (count + 1)) for i, name in enumerate(names)}
        if optional := draws.chance("optional", self.optional):
            stops[names[-2]]["reward"] = draws.number("reward", self.reward_s)
        return {
            **self.way.ends(draws),
            "stops": stops,
            "order": "free" if draws.chance("free", self.free) else "fixed",
            "visit": "optional" if optional else "all",
            "intervals": self.intervals_per_leg * (count + 1),
        }

    def _stop(self, draws: Draws, name: str, spread: float) -> dict[str, Any]:
        along = spread + draws.number(f"{name} along", self.along)
        place, time = self.way.beside(draws, name, along)
        seconds = draws.number(f"{name} contact", self.contact_s)
        return {
            "target": self.targets.draw(draws, name, place, time),
            "contact_seconds": seconds,
            "kappa_init": 1 + round(seconds / self.step_s),
        }
