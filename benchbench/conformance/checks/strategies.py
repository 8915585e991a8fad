"""What every strategy must do on a small handover: an honest result, the same for the same seed, within its time."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from benchbench.conformance.checks.require import close, require
from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case, Strategy
from benchbench.planning.guess import first_plan
from benchbench.planning.result import Result
from benchbench.planning.strategy import planned
from benchbench.storage.schema import make_record

GRANTED = 20.0
"""Wall seconds beyond its time limit that a strategy may take, to build and to end a solve."""


Planned = tuple[Result, Ledger]


@dataclass(frozen=True)
class Tried:
    """What a strategy makes of a small case, solved once for all checks."""

    strategy: Strategy
    case: Case

    @cached_property
    def seeded(self) -> Case:
        """The case with a seed, so that chance plays its part where there is any."""
        return replace(self.case, seed=3)

    @cached_property
    def first(self) -> Planned:
        """Its result, and the effort."""
        return self.solve(self.seeded)

    def solve(self, case: Case) -> Planned:
        """Solve once more."""
        ledger = Ledger(case.time_limit)
        return planned(self.strategy, replace(case, strategy=self.strategy), ledger), ledger


def check_result(tried: Tried) -> None:
    """What is called solved keeps its problem; plan and objective are those of the solution; effort is counted.

    What a strategy tells of itself has a column in the record.
    """
    result, ledger = tried.first
    plan, found = result.plan, result.solution.residuals
    require(result.claimed, f"did not solve a small case: {result.solved.outcome.detail}")
    require(
        found.max_violation <= 1e-6, f"'{found.worst_constraint}' is violated by {found.max_violation:.3g}"
    )
    require(found.max_complementarity <= 1e-4, f"pairs are violated by {found.max_complementarity:.3g}")
    again = result.problem.decode(result.solved.values)
    close(plan.configuration, again.configuration, 1e-12, "plan")
    require(bool(plan.contacts), "the plan claims no contact")
    require(result.objective >= plan.travel_time - 1e-9, "the cost is below the travel time it contains")
    require(ledger.iterations > 0 and ledger.solve_cpu > 0, "solves are not counted")
    require(ledger.build_cpu > 0, "building is not counted")
    make_record(**result.account)


def check_repeatable(tried: Tried) -> None:
    """The same seed gives the same plan, bit by bit; the seed reaches the start."""
    (one, _), (again, _) = tried.first, tried.solve(tried.seeded)
    require(np.array_equal(one.plan.configuration, again.plan.configuration), "differs for equal seeds")
    require(one.account == again.account, "tells another story for equal seeds")
    start, moved = (first_plan(c, Ledger(60.0)) for c in (tried.case, tried.seeded))
    require(not np.allclose(start.time, moved.time), "a seed does not change the start")


def check_time(tried: Tried) -> None:
    """Almost no time: a result all the same, soon."""
    began = time.perf_counter()
    result, _ = tried.solve(replace(tried.case, time_limit=0.05))
    require(result.plan.intervals > 0, "no plan")
    require(time.perf_counter() - began < GRANTED, "goes on long after its time")


CHECKS = (check_result, check_repeatable, check_time)
