"""A start with the right contact time: the plan of phases, moved onto the grid of the MPCC."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench import posing
from benchbench.case import Case, Ledger
from benchbench.guess import Guess
from benchbench.plan import Plan
from benchbench.strategy import pose


@final
@dataclass(frozen=True)
class Phases(Guess):
    """Solve phases, then one step size with the contact, or the gates, held at the nearest nodes; both smooth.

    The second solve matters: the interpolated plan breaks the dynamics of the new grid, and IPOPT leaves the
    window on its way back. `sequence`: the stops that are made, in order; none: as they are listed.
    """

    sequence: tuple[str, ...] = ()

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Two solves."""
        made = posing.chosen(case, self.sequence, "guess.sequence")
        start = posing.start(case, ledger, made)
        with ledger.building():
            problem = posing.phases(case, start)
        found = pose(problem, case, ledger, "guess: phases").plan
        with ledger.building():
            problem = posing.held(case, found)
        return pose(problem, case, ledger, "guess: window").plan
