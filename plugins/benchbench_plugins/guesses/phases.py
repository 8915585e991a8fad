"""A start with the right contact time: the plan of phases, moved onto the grid of the MPCC."""

from __future__ import annotations

from typing import final

from pydantic import ConfigDict, InstanceOf
from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning import posing
from benchbench.planning.case import Case, Guess
from benchbench.planning.ladder import from_phases


@final
@dataclass(frozen=True, config=ConfigDict(arbitrary_types_allowed=True))
class Phases(Guess):
    """Solve phases, then one step size with the contact, or the gates, held at the nearest nodes; both smooth.

    start: what the phases start from; sequence: the stops that are made, in order, in a simple start instead.
    """

    start: InstanceOf[Guess]
    sequence: tuple[str, ...] = ()

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Two solves."""
        made = posing.chosen(case, self.sequence, "guess.sequence")
        start = posing.start(case, ledger, made) if made else self.start.plan(case, ledger)
        return from_phases(case, ledger, start).plan
