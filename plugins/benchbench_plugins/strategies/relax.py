"""The paper's way: one MPCC with progress variables, relaxed and solved from one guess."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.homotopy import Solved, homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.method import Method
from benchbench.planning import posing
from benchbench.planning.case import Case, MpccStrategy
from benchbench.planning.guess import first_plan
from benchbench.planning.ladder import beside, coarse, staged
from benchbench.planning.loop import settled
from benchbench.planning.margins import own_margins
from benchbench.planning.proximal import PRICE
from benchbench.planning.result import Result
from benchbench.planning.strategy import pose
from benchbench.planning.windows import check_counted


@final
@dataclass(frozen=True)
class Relax(MpccStrategy):
    """Homotopy on the DMCC problem (paper Eq. 33), when the contact happens is left to the optimiser.

    Races: at which nodes the gates are passed (complementary progress constraints). A quarter of the grid comes first where the first
    solve fails, and where gates or several contacts meet stages (collocation, Runge-Kutta): each step of one along the nodes is many iterations.
    Where the certificate refuses, margins are measured, errors of the transcription taken off and grids refined, each
    from the plan and the multipliers of the last and with the last sigma only.

    margin    largest share of a limit left unused, beyond the scenario's margins, because the replay exceeded it; 0: one grid, nothing measured
    finer     a grid is refined as long as it has fewer than so many times the intervals of the scenario
    patience  iterations granted to a solve while there is a coarser grid to begin with
    """

    margin: Annotated[float, Field(ge=0, lt=1)] = 0.5
    finer: Annotated[int, Field(ge=1, le=64)] = 4
    patience: Annotated[int, Field(ge=1)] = 400

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Guess, pose, relax, go on; raises IncompatibleCase for contacts that are to last for seconds."""
        check_counted(case)
        found = self._relaxed(case, ledger)
        least = own_margins(case.scenario)
        return settled(case, ledger, found, self.finer, self.margin, least, _again)

    def solve_mpcc(self, mpcc: Mpcc, case: Method, ledger: Ledger) -> Solved:
        """Relax, from the guess it comes with."""
        return homotopy(mpcc, case, ledger, "relaxation")

    def _relaxed(self, case: Case, ledger: Ledger) -> Result:
        """The plan on the case's own grid."""
        first = coarse(case) if self.margin else case
        if first is case:
            return _first(case, ledger)
        if len(case.scenario.itinerary.stops) == 1 or not staged(first):
            limited = replace(case, iteration_limit=min(self.patience, case.iteration_limit))
            found = _first(limited, ledger)
            if found.claimed or ledger.over:
                return found
        below = _first(first, ledger)
        return _again(case, ledger, below, False) if below.claimed and not ledger.over else below


def _first(case: Case, ledger: Ledger) -> Result:
    start = first_plan(case, ledger)
    with ledger.building():
        problem = posing.free(case, start)
    return pose(problem, case, ledger, "relaxation")


def _again(case: Case, ledger: Ledger, near: Result, correct: bool) -> Result:
    """The last sigma, from a result of another grid or other margins; `correct`: with the error of the transcription taken off."""
    with ledger.building():
        problem = posing.free(case, near.plan)
        if correct:
            problem = beside(problem, case, near, PRICE)
    return pose(problem, case, ledger, f"N = {case.scenario.grid_intervals}", near)
