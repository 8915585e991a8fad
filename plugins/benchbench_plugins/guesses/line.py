"""The plain start that benchmarks of relaxations use."""

from __future__ import annotations

from typing import final

from pydantic.dataclasses import dataclass

from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning import posing
from benchbench.planning.case import Case, Guess


@final
@dataclass(frozen=True)
class Line(Guess):
    """Straight line over the target, contact where the scenario guesses it; or from gate to gate."""

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Costs nothing."""
        return posing.line(case)
