"""Solve on a coarse grid, fly the plan, let the certificate's findings decide what is next, until it is certified."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.ocp.sizes import Tries
from benchbench.planning.case import Case, Strategy
from benchbench.planning.disturb import disturbed
from benchbench.planning.loop import Loop, Refinement
from benchbench.planning.result import Result


@final
@dataclass(frozen=True)
class Auto(Strategy):
    """Phases on a ladder of grids, with the replay as judge (`benchbench.planning.loop`).

    finer   the finest grid has so many times the intervals of the scenario
    margin  largest share of a limit left unused because the replay exceeded it between nodes
    refinement  local: a grid is refined where the replay found errors; uniform: everywhere
    starts  how many starts are tried until one is certified
    patience  iterations granted to a solve that is not the last start's: a good start needs a tenth of that
    """

    finer: Annotated[int, Field(ge=1, le=64)] = 8
    margin: Annotated[float, Field(ge=0, lt=1)] = 0.5
    refinement: Refinement = "local"
    starts: Tries = 4
    patience: Tries = 400

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Return the first certified result; without one that with the fewest broken limits."""
        loop = Loop(case, ledger, self.finer * case.scenario.grid_intervals, self.margin, self.refinement)
        for number in range(self.starts):
            last = number == self.starts - 1
            limit = case.iteration_limit if last else min(case.iteration_limit, self.patience)
            if (
                loop.round(replace(case, iteration_limit=limit), self._start(case, ledger, number))
                or ledger.over
            ):
                break
        return loop.best.telling(refinement=loop.told)

    def _start(self, case: Case, ledger: Ledger, number: int) -> Plan:
        guessed = case.guess.plan(case, ledger)
        return disturbed(guessed, case, case.seed if number == 0 else 10**6 + 1000 * case.seed + number)
