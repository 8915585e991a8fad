"""Search for the best contact window: which nodes of a grid of equal steps are in contact, each choice one smooth solve.

The travel time over the first node in contact is near to unimodal (measured, not proved), so the search walks downhill
from window to window, each solve warm started from its neighbour. Windows whose lower bound is no better than the best
solution need no solve.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property, singledispatch

import numpy as np

from benchbench.certificate.window_bound import window_bounds
from benchbench.formulation.handover import fixed_window, nearest_windows
from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.handover import Handover
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario
from benchbench.planning.case import Case
from benchbench.planning.ladder import beside
from benchbench.planning.proximal import PRICE
from benchbench.planning.result import Result
from benchbench.planning.search import Account
from benchbench.planning.strategy import pose


@dataclass
class Windows:
    """Windows by their first node k: kappa_init nodes from k on.

    start: what a first solve starts from, and any that fails from elsewhere; known: a solved window of nearly the same
    problem, whose multipliers the first solve starts from; correct: with the error of the transcription taken off as it is there; bounded:
    use lower bounds, which a mere start does not need.
    """

    case: Case
    ledger: Ledger
    start: Plan
    known: Result | None = None
    bounded: bool = True
    correct: bool = False
    found: dict[int, Result] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Raise IncompatibleCase for another scenario than one with one contact of kappa_init nodes."""
        check_one_contact(self.case)
        self.count = self.case.scenario.itinerary.stops[0].kappa_init

    @cached_property
    def bounds(self) -> Array:
        """Lower bounds in s by first node."""
        scenario = self.case.scenario
        first = np.arange(scenario.grid_intervals - self.count + 1)
        last = first + self.count - 1
        shares = first / scenario.grid_intervals, last / scenario.grid_intervals
        with self.ledger.building():
            return window_bounds(scenario, self.case.model, self.case.limits, *shares)

    @property
    def nearest(self) -> int:
        """The window nearest to the contact of `start`; if it has none, the one with the lowest bound."""
        for window in nearest_windows(self.case, self.start).values():
            return window[0]
        return int(np.argmin(self.bounds))

    @property
    def valley(self) -> float:
        """Share of the flight at which the middle of a window costs least: of the parabola through the best three."""
        k = self.centre
        costs = [self.found[i].objective if i in self.found else np.inf for i in (k - 1, k, k + 1)]
        bent = costs[0] - 2 * costs[1] + costs[2]
        shift = (costs[0] - costs[2]) / (2 * bent) if np.isfinite(bent) and bent > 0 else 0.0
        return (k + shift + (self.count - 1) / 2) / self.case.scenario.grid_intervals

    def first_at(self, share: float) -> int:
        """First node of the window whose middle is nearest to a share of the flight."""
        intervals = self.case.scenario.grid_intervals
        return int(np.clip(round(share * intervals - (self.count - 1) / 2), 0, intervals + 1 - self.count))

    @property
    def best(self) -> Result:
        """The best that was found; the first where all failed."""
        return min(self.found.values(), key=lambda result: result.objective)

    @property
    def centre(self) -> int:
        """First node of the best window."""
        return min(self.found, key=lambda k: self.found[k].objective)

    def solve(self, first: int) -> Result:
        """Solve one window."""
        self._solve(first)
        return self.found[first]

    def descend(self, first: int) -> Windows:
        """Solve a window, then neighbours of the best one until both are no better."""
        self._solve(first)
        while not self.ledger.over:
            new = [k for k in (self.centre - 1, self.centre + 1) if self._open(k)]
            if not new:
                break
            self._solve(new[0])
        return self

    def exhaust(self) -> Windows:
        """Solve every window that may be better than the best, from the best outwards."""
        centre = self.centre
        for k in sorted(range(len(self.bounds)), key=lambda k: abs(k - centre)):
            if self.ledger.over:
                break
            if self._open(k):
                self._solve(k)
        return self

    def account(self) -> Account:
        """What became of all windows."""
        solved = sum(result.claimed for result in self.found.values())
        rest = [k for k in range(len(self.bounds)) if k not in self.found]
        pruned = sum(self.bounds[k] >= self.best.objective for k in rest)
        return Account(solved, len(self.found) - solved, int(pruned), len(rest) - int(pruned))

    def _open(self, k: int) -> bool:
        last = self.case.scenario.grid_intervals + 1 - self.count
        new = 0 <= k <= last and k not in self.found
        return new and not (self.bounded and self.bounds[k] >= self.best.objective)

    def _solve(self, k: int) -> None:
        """From the nearest solved window with its multipliers; if that fails, from the start without."""
        near = self._near(k)
        for known in [near, None] if near else [None]:
            start = known.plan if known else self.start
            with self.ledger.building():
                problem = fixed_window(self.case, start, range(k, k + self.count))
                if known and self.correct:
                    problem = beside(problem, self.case, known, PRICE)
            self.found[k] = pose(problem, self.case, self.ledger, f"window {k}", known)
            if self.found[k].claimed or self.ledger.over:
                return

    def _near(self, k: int) -> Result | None:
        good = [other for other, result in self.found.items() if result.claimed]
        return self.found[min(good, key=lambda other: abs(other - k))] if good else self.known


def solved_again(case: Case, ledger: Ledger, near: Result, correct: bool = False) -> Result:
    """Solve the window of a searched result once more, with the margins that the case has now."""
    windows = Windows(case, ledger, near.plan, near, correct=correct)
    return windows.solve(windows.nearest)


def check_one_contact(case: Case) -> None:
    """Raise IncompatibleCase unless one stop has to be made, for kappa_init nodes."""
    scenario, strategy = case.scenario, case.names["strategy"]
    if len(scenario.itinerary.stops) != 1:
        problem = f"'{strategy}' searches for one contact"
        raise IncompatibleCase("strategy", problem, "phases, sequences, orders")
    (stop,) = scenario.itinerary.stops
    if scenario.itinerary.may_skip(stop):
        problem = f"'{strategy}' searches where the contact is, not whether there is one"
        raise IncompatibleCase("strategy", problem, "sequences, phases")
    check_counted(case)


def check_counted(case: Case) -> None:
    """Raise IncompatibleCase for contacts that are to last for seconds: on a grid of equal steps they last for nodes."""
    for stop in case.scenario.itinerary.stops:
        if stop.contact_seconds is not None:
            strategy, where = case.names["strategy"], f"{stop.prefix}contact"
            problem = f"'{strategy}' holds {where} at kappa_init nodes, not for {stop.contact_seconds:g} s"
            raise IncompatibleCase("scenario.contact_seconds", problem, "null, or strategy=auto, phases")


def coarser(case: Case, levels: int) -> Iterable[Case]:
    """The case on grids of N / 2^(levels - 1), ..., N / 2, N intervals, its contact as long in s as it can be."""
    for level in range(levels - 1, 0, -1):
        if small := coarsened(case.scenario, 2**level):
            yield replace(case, scenario=small)
    yield case


@singledispatch
def coarsened(scenario: Scenario, factor: int) -> Scenario | None:
    """Return the scenario on a grid of N / factor intervals, its contact as long in s; None where that is too coarse."""
    return None


@coarsened.register
def _(scenario: Handover, factor: int) -> Scenario | None:
    small = scenario.on_grid(scenario.intervals // factor)
    count = max(stop.kappa_init for stop in small.itinerary.stops)
    return small if small.intervals >= max(10, 2 * count) else None
