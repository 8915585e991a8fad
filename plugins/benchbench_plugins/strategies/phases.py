"""The fast planner for a contact whose order is known: three phases, no complementarity."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.case import Case, Ledger
from benchbench.formulation import phases
from benchbench.guess import straight_line
from benchbench.strategy import Result, Strategy, pose


@final
@dataclass(frozen=True)
class Phases(Strategy):
    """One smooth solve with free durations before and after the contact, from a straight line.

    The relaxation and the guess of the case play no part.
    """

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Guess, pose, solve."""
        with ledger.building():
            problem = phases(case, straight_line(case))
        return pose(problem, case, ledger, "phases")
