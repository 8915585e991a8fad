"""The cheapest start from which the phases of a scenario are solved."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning import posing
from benchbench.planning.case import Case, Guess


@final
@dataclass(frozen=True)
class Simple(Guess):
    """Straight line over the target (`line`); for a race the flight of a point mass (`point_mass`)."""

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Costs nothing; in a race one small solve."""
        return posing.start(case, ledger)
