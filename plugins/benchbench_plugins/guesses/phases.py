"""A start with the right contact time: the three-phase plan, moved onto the grid of the MPCC."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.case import Case, Ledger
from benchbench.formulation import fixed_window, nearest_window, phases
from benchbench.guess import Guess, straight_line
from benchbench.plan import Plan
from benchbench.strategy import pose


@final
@dataclass(frozen=True)
class Phases(Guess):
    """Solve three phases, then one step size with the contact held at the nearest nodes; both smooth.

    The second solve matters: the interpolated three-phase plan breaks the dynamics of the new grid, and
    IPOPT leaves the window on its way back.
    """

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Two solves."""
        with ledger.building():
            problem = phases(case, straight_line(case))
        found = pose(problem, case, ledger, "guess: phases").plan
        with ledger.building():
            trajectory = fixed_window(case, found, (0,)).trajectory
            window = nearest_window(found, trajectory, case.scenario.kappa_init)
            problem = fixed_window(case, found, window)
        return pose(problem, case, ledger, "guess: window").plan
