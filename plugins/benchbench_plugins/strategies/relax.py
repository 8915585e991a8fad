"""The paper's way: one MPCC with progress variables, relaxed and solved from one guess."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.homotopy import Solved, homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.method import Method
from benchbench.planning import posing
from benchbench.planning.case import Case, MpccStrategy
from benchbench.planning.guess import first_plan
from benchbench.planning.result import Result
from benchbench.planning.strategy import pose


@final
@dataclass(frozen=True)
class Relax(MpccStrategy):
    """Homotopy on the DMCC problem (paper Eq. 33), when the contact happens is left to the optimiser.

    Races: at which nodes the gates are passed (complementary progress constraints).
    """

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Guess, pose, relax."""
        start = first_plan(case, ledger)
        with ledger.building():
            problem = posing.free(case, start)
        return pose(problem, case, ledger, "relaxation")

    def solve_mpcc(self, mpcc: Mpcc, case: Method, ledger: Ledger) -> Solved:
        """Relax, from the guess it comes with."""
        return homotopy(mpcc, case, ledger, "relaxation")
