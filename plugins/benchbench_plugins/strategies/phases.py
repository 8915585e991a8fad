"""The fast planner for contacts or gates whose order is known: phases, no complementarity."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench import posing
from benchbench.case import Case, Ledger
from benchbench.strategy import Result, Strategy, pose


@final
@dataclass(frozen=True)
class Phases(Strategy):
    """One smooth solve with free durations before and after the contact, from a straight line.

    Races: one free duration from gate to gate, from the time-optimal flight of a point mass. The relaxation and the
    guess of the case play no part.
    """

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Guess, pose, solve."""
        start = posing.start(case, ledger)
        with ledger.building():
            problem = posing.phases(case, start)
        return pose(problem, case, ledger, "phases")
