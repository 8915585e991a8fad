"""The paper's way: one MPCC with progress variables, relaxed and solved from one guess."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.case import Case, Ledger
from benchbench.formulation import free_contact
from benchbench.strategy import Result, Strategy, pose


@final
@dataclass(frozen=True)
class Relax(Strategy):
    """Homotopy on the DMCC problem (paper Eq. 33); when the contact happens is left to the optimiser."""

    def solve(self, case: Case, ledger: Ledger) -> Result:
        """Guess, pose, relax."""
        start = case.guess.plan(case, ledger)
        with ledger.building():
            problem = free_contact(case, start)
        return pose(problem, case, ledger, "relaxation")
