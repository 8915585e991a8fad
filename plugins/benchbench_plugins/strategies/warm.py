"""The paper's MPCC, entered at its far end: from the multipliers of a smooth solve with the contact held."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.planning import posing
from benchbench.planning.case import Case, Strategy
from benchbench.planning.guess import first_plan
from benchbench.planning.ladder import from_phases
from benchbench.planning.result import Result
from benchbench.planning.strategy import pose


@final
@dataclass(frozen=True)
class Warm(Strategy):
    """Phases, one step size with contact or gates held, then progress variables and complementarity for the last sigma.

    What the smooth solve ends with, multipliers included, is nearly a solution of the MPCC: a solver that starts warm
    (solver=ipopt) needs few iterations to tell whether contact or gates should move. `sequence`: the stops that are made, in order,
    in a simple start instead of the guess of the case.
    """

    sequence: tuple[str, ...] = ()

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Three solves."""
        made = posing.chosen(case, self.sequence, "strategy.sequence")
        start = posing.start(case, ledger, made) if made else first_plan(case, ledger)
        held = from_phases(case, ledger, start)
        with ledger.building():
            problem = posing.free(case, held.plan)
        return pose(problem, case, ledger, "relaxation", held)
