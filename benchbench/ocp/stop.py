"""A stop of a scenario, a target to be touched, and the sequences in which stops may be made."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, combinations, permutations

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.contact import Contacts, NoseContact
from benchbench.ocp.motion import Motion
from benchbench.ocp.plan import ONLY
from benchbench.ocp.values import Order, Visit


@dataclass(frozen=True)
class Stop:
    """One contact event, known by its name: touch `target` with all `contacts` for `kappa_init` nodes or `contact_seconds` s.

    reward   seconds that making the stop is worth where it may be left out; None: it has to be made
    prefix   what its variables and blocks are called by; empty for the only stop of a scenario with a `target`
    counted  (steps, N): how long a contact without seconds lasts, so many average steps of a grid of N intervals;
             None: the nodes are counted on whatever grid a plan has
    """

    name: str
    target: Motion = field(compare=False)
    contacts: Contacts = field(compare=False)
    kappa_init: int = field(compare=False)
    contact_seconds: float | None = field(default=None, compare=False)
    reward: float | None = field(default=None, compare=False)
    prefix: str = field(default="", compare=False)
    counted: tuple[int, int] | None = field(default=None, compare=False)

    def steps(self, intervals: int) -> tuple[int, int]:
        """How long a contact without seconds lasts: average steps, and N of their grid; `intervals`: N of the plan's."""
        return self.counted or (self.kappa_init - 1, intervals)

    @property
    def label(self) -> str:
        """What a sentence adds to name the stop; nothing where there is only one."""
        return f" of '{self.name}'" if self.prefix else ""

    @property
    def reach(self) -> float | None:
        """How far in m the end effector may be from the target in contact; None where no contact says so."""
        return min((c.reach for c in self.contacts.values() if c.reach is not None), default=None)

    @property
    def heading_error(self) -> float | None:
        """How far in rad the nose may be off the target's direction in contact; None where no contact says so."""
        asked = (c.heading_error for c in self.contacts.values() if isinstance(c, NoseContact))
        return min(asked, default=None)

    def lasts(self, travel_time: float) -> float:
        """How long the contact lasts at least, s, in a flight of so many s; 0 where only nodes are counted."""
        if self.contact_seconds is not None:
            return self.contact_seconds
        steps, grid = self.counted or (0, 1)
        return steps * travel_time / grid

    def named(self, what: str) -> str:
        """Return what something of this stop is called in a recording."""
        return f"{what}_{self.name}" if self.prefix else what


@dataclass(frozen=True)
class Itinerary:
    """All stops of a scenario, perhaps none, and what is asked of them.

    order    "fixed": as they are listed; "free": any
    visit    "all": every stop; "one": exactly one of them; "optional": those with a reward may be left out
    middle   where in the flight, as a share of its time, the stops are first guessed
    margins  share of the limits of contacts that the planner leaves unused, by contact name
    """

    stops: tuple[Stop, ...] = ()
    order: Order = "fixed"
    visit: Visit = "all"
    middle: float = 0.5
    margins: Mapping[str, float] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all stops as they are listed."""
        return tuple(stop.name for stop in self.stops)

    @property
    def claimed(self) -> tuple[str, ...]:
        """Names of the columns of a plan's progress: those of the stops; without any there is one all the same."""
        return self.names or ONLY

    @property
    def listed(self) -> tuple[Stop, ...]:
        """The obvious sequence: all stops as they are listed, or the first where one is enough."""
        return self.stops[:1] if self.visit == "one" else self.stops

    def may_skip(self, stop: Stop) -> bool:
        """Whether a flight that leaves this stop out may be right."""
        return self.visit == "one" or (self.visit == "optional" and stop.reward is not None)

    @property
    def may_skip_all(self) -> bool:
        """Whether a flight without any stop may be right."""
        return not self.stops or (self.visit == "optional" and all(map(self.may_skip, self.stops)))

    def sequences(self) -> Iterator[tuple[Stop, ...]]:
        """Every sequence of stops that is allowed, the obvious one first."""
        if self.visit == "one":
            yield from ((stop,) for stop in self.stops)
            return
        open_ = [stop for stop in self.stops if self.may_skip(stop)]
        fewer = chain.from_iterable(combinations(open_, k) for k in range(len(open_) + 1))
        for skipped in fewer:
            made = tuple(stop for stop in self.stops if stop not in skipped)
            yield from permutations(made) if self.order == "free" else (made,)

    def sequence(self, names: Sequence[str], field: str) -> tuple[Stop, ...]:
        """Return the stops of these names in this order; raises BadInput where that is not allowed."""
        for name in names:
            if name not in self.names:
                raise BadInput(field, f"there is no stop '{name}'", ", ".join(self.names))
        made = tuple(self.stops[self.names.index(name)] for name in names)
        if made not in self.sequences():
            problem = f"[{', '.join(names)}] is not what the scenario asks for"
            raise BadInput(field, problem, "; ".join(_spoken(s) for s in self.sequences()))
        return made


def _spoken(sequence: tuple[Stop, ...]) -> str:
    return "[" + ", ".join(stop.name for stop in sequence) + "]"


def spread(count: int, middle: float) -> Array:
    """Shares (count,) of the flight at which so many stops are first guessed: even, if `middle` is one half."""
    return np.interp(np.arange(1, count + 1) / (count + 1), [0.0, 0.5, 1.0], [0.0, middle, 1.0])
