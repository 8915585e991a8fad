"""A start with the right contact time: the plan of phases, moved onto the grid of the MPCC."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench import posing
from benchbench.case import Case, Ledger
from benchbench.guess import Guess
from benchbench.plan import Plan
from benchbench.strategy import from_phases


@final
@dataclass(frozen=True)
class Phases(Guess):
    """Solve phases, then one step size with the contact, or the gates, held at the nearest nodes; both smooth.

    `sequence`: the stops that are made, in order; none: as they are listed.
    """

    sequence: tuple[str, ...] = ()

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Two solves."""
        return from_phases(case, ledger, posing.chosen(case, self.sequence, "guess.sequence")).plan
